#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "fitting/hbFit.h"
#include "raycast/hbInput.h"
#include "report/hbSetChoice.h"
#include "sparsegrid/hbSparseGridFile.h"
#include "volume/hbProgress.h"

/// How an input becomes a sparse grid, and what is said about the loss.
struct hbSparseCompression {
  enum class Measure : std::uint8_t {
    automatic, ///< All samples up to kMeasureAll, otherwise sampled.
    all,       ///< Every sample (analytic fields have none: sampled).
    sampled,   ///< kRandomSamples samples, or kRandomPoints of an analytic field, the same ones every time.
    none
  };
  static constexpr std::int64_t kMeasureAll = std::int64_t{1} << 26;
  static constexpr std::int64_t kRandomSamples = std::int64_t{1} << 17;
  static constexpr std::int64_t kRandomPoints = std::int64_t{1} << 20;

  hbSetChoice set;
  hbLatticeMapping mapping = hbLatticeMapping::fitted;
  std::optional<hbFit> fit; ///< To all samples; none: interpolation. Its memory limit is what is left of this one's.
  Measure measure = Measure::automatic;
  std::optional<double> nonFinite; ///< What NaN and infinite samples count as; none: they are refused.
  std::uint64_t memoryLimit = std::numeric_limits<std::uint64_t>::max(); ///< Bytes.

  struct Result {
    hbSparseGridFile file;
    std::vector<hbFitReport> fits; ///< One a component, where there was one.
  };

  /// Interpolates, fits and measures. Volumes of up to kMeasureAll samples are scanned for their range and for samples
  /// that are not finite; of larger ones only the nodes, and what fitting and measuring look at, are read. Throws
  /// hbError for a sparse grid as input, where hbSetChoice does, samples that are not finite, and where the estimate of
  /// memory exceeds the limit, or what a fit throws (hbFit::run()).
  Result compress(const hbInput& input, hbProgress& progress = hbProgress::none()) const;

private:
  hbRangeRecord rangeOf(const hbInput& input, hbProgress& progress) const;
  hbErrorRecord errorsOf(const hbInput& input, const hbField& source, const hbSparseGrid& grid,
                         hbProgress& progress) const;
};
