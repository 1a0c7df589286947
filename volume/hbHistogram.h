#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

/// The statistics of one component's values. NaN and infinite values are counted and otherwise left out.
struct hbHistogram {
  std::int64_t count = 0; ///< Finite values.
  std::int64_t nans = 0;
  std::int64_t infinities = 0;
  double min = 0.0, max = 0.0, mean = 0.0; ///< Of the finite values; NaN where there are none.
  double deviation = 0.0;                  ///< Standard deviation of the population; values beyond 1e150 overflow it.

  /// Counts in equal intervals from min to max; a value on a border counts above, max in the last. All in the first
  /// where min = max.
  std::vector<std::int64_t> bins;

  /// The same, finer, for percentiles and thresholds: one count for each value of integers whose range is below 65536,
  /// else 65536 equal intervals.
  std::vector<std::int64_t> fine;
  double fineStep = 0.0; ///< From one fine count to the next, in values.
  bool exact = false;    ///< Fine count i is that of the value min + i * fineStep, not of an interval.

  /// The smallest value that a fraction `p` in [0,1] of the values does not exceed: exact for `exact` counts, otherwise
  /// interpolated, off by less than fineStep. percentile(0) is min, percentile(1) max. NaN without values.
  double percentile(double p) const;

  /// The threshold that separates the values into two classes (value <= t and value > t) with the largest variance
  /// between them: N. Otsu, "A threshold selection method from gray-level histograms", 1979, eq. 12. Where an empty
  /// gap of values does equally well, its middle. A constant gives the constant; NaN without values.
  double otsuThreshold() const;
};

namespace hb {

/// One histogram a component, of all samples, in their data values (slope and intercept applied). Reads the samples
/// twice, in parallel; the result does not depend on the number of threads. `bins` >= 1.
std::vector<hbHistogram> calcHistograms(const hbVolume& volume, int bins = 256,
                                        hbProgress& progress = hbProgress::none());

/// The histogram of some values, such as those of a field.
hbHistogram calcHistogram(std::span<const float> values, int bins = 256, hbProgress& progress = hbProgress::none());

} // namespace hb
