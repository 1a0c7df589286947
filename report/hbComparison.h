#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fitting/hbFit.h"
#include "glcombine/hbRenderer.h"
#include "report/hbPeers.h"
#include "scene/hbScene.h"

/// What `hbvol compare` sets beside each other: sparse grids of several levels, drawn by several engines in several
/// modes.
struct hbComparison {
  /// A way to make pictures of a sparse grid: an engine, and of OpenGL a form. Names: full, seminodal, direct,
  /// combination, lattice, opengl (its form seminodal), opengl-fused, opengl-blend.
  struct Engine {
    std::string name;
    hbEngine engine = hbEngine::seminodal;
    hbOglRaycaster::Form form = hbOglRaycaster::Form::seminodal;
    bool operator==(const Engine&) const = default;
  };
  /// All of them, in the order of reports.
  static const std::vector<Engine>& allEngines();
  /// The engine of that name; throws hbError for another one, naming those there are.
  static Engine engineFromName(std::string_view name);

  /// A way to fit sparse grids to all samples: opticom, least-squares.
  struct Fit {
    std::string name;
    hbFit::Method method = hbFit::Method::leastSquares;
    std::string inWords() const; ///< "least squares"
    bool operator==(const Fit&) const = default;
  };
  /// All of them, in the order of reports.
  static const std::vector<Fit>& allFits();
  /// Whether choices of that kind are sparse grids: "sparse", which interpolate, and the names of allFits().
  static bool isSparseGrid(std::string_view kind);

  /// What is asked of a choice; none: a default of the volume's, see hb::recommendations().
  struct Limits {
    std::optional<double> maxError; ///< In data values.
    std::optional<double> frameSeconds;
    std::optional<double> bytes;
  };

  static constexpr int kFirstLevel = 5, kLastLevel = 8;

  int firstLevel = kFirstLevel, lastLevel = kLastLevel; ///< 1 to hbIndexSet::kMaxLevel.
  std::vector<Engine> engines{allEngines().begin(), allEngines().begin() + 6};
  std::vector<hbMode> modes{hbMode::xray, hbMode::mip, hbMode::iso, hbMode::dvr}; ///< Not slices.
  std::vector<Fit> fits;                        ///< Beside interpolation, which always takes part; each once.
  hbFitLoss::Kind loss = hbFitLoss::Kind::none; ///< Of the fits.
  hbScene scene;   ///< Everything but the mode. `sampling.samples` must be given; labels and slices are not drawn.
  int repeats = 5; ///< Frames timed of a case, after one to warm up; fewer where they would take over kMostSeconds.
  /// Where other programs are looked for, to be put beside ours (hbPeers); none: they take no part.
  std::optional<std::vector<std::filesystem::path>> peerFolders = hbPeers::folders();
  bool restart = false;            ///< Begin anew in a folder that holds a comparison.
  std::optional<double> nonFinite; ///< What NaN and infinite samples count as; none: they are refused.
  int threads = 0;                 ///< For the record, and Mesa's; 0: one a core.
  std::uint64_t memoryLimit = std::numeric_limits<std::uint64_t>::max(); ///< Bytes; cases that need more fail.
  Limits limits;
  std::string command; ///< For the record.
  std::string version;

  static constexpr double kMostSeconds = 10.0;

  /// Throws hbError for levels, engines or modes that are none or out of range, a fit that is there twice, and a loss
  /// without a fit.
  void validate() const;

  /// What decides figures: a comparison with other settings cannot go on where this one stopped. "fits" and "loss" are
  /// members where there are fits.
  nlohmann::ordered_json settings() const;
};
