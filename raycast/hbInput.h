#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "raycast/hbEngine.h"
#include "sparsegrid/hbSparseGridFile.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbContainerReader.h"
#include "volume/hbField.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"
#include "volume/hbVolumeReader.h"

/// Anything hbvol can look at, opened: a volume file, an `.hbv` file or an analytic field. The one closed list of
/// representations; exactly one of the three pointers is set.
struct hbInput {
  static constexpr std::string_view kFieldPrefix = "field:";

  std::string name; ///< As it was asked for.
  std::shared_ptr<const hbVolume> volume;
  std::shared_ptr<const hbAnalyticField> analytic;
  std::shared_ptr<const hbSparseGridFile> sparse;
  /// The open `.hbv` file that `sparse` came from: whoever asks for more sees the same one, though another program may
  /// have replaced it by now.
  std::shared_ptr<const hbContainerReader> container;
  std::uint64_t fileBytes = 0; ///< 0 for analytic fields and folders.

  /// "volume", "analytic" or "sparse".
  std::string representation() const;
  const hbGeometry& geometry() const;
  int components() const;

  /// Opens "field:NAME[,parameter=value...]", an `.hbv` file (told by its content, whatever its name), or what
  /// hb::readVolume() reads. Throws hbError.
  static hbInput open(const std::string& name, const hbReadOptions& options, hbProgress& progress = hbProgress::none());

  /// The field that evaluates the input with that engine; it shares the input's data. NaN and infinite samples of a
  /// volume count as `nonFinite` where it is given. Throws hbError for an engine that cannot evaluate this
  /// representation. The engines seminodal and combination are built here: 4 bytes for each of
  /// hbIndexSet::storedValues(), or of combinationValues(); so is `full` of a sparse grid, see hb::extractFullGrid().
  /// `lattice`
  /// and `opengl` are the sparse grid itself.
  std::shared_ptr<const hbField> field(hbEngine engine, std::optional<double> nonFinite = std::nullopt,
                                       hbProgress& progress = hbProgress::none()) const;

  /// What field() takes beside what is loaded already, at its peak, in bytes; for `lattice`, what an hbShearWarp takes;
  /// for `opengl`, see hbOglRaycaster::bytes().
  double fieldBytes(hbEngine engine) const;

  /// What `automatic` stands for here.
  hbEngine engine(hbEngine asked) const;
};
