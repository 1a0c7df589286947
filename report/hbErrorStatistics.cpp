#include "report/hbErrorStatistics.h"

#include <algorithm>
#include <cmath>

void hbErrorStatistics::add(double reference, double value) {
  ++count;
  if (std::isfinite(reference)) {
    lo = std::min(lo, reference);
    hi = std::max(hi, reference);
  }
  if (reference == value || (std::isnan(reference) && std::isnan(value))) return;
  double error = std::abs(reference - value);
  if (std::isnan(error)) error = std::numeric_limits<double>::infinity();
  max = std::max(max, error);
  sumSquares += error * error;
}

void hbErrorStatistics::merge(const hbErrorStatistics& later) {
  count += later.count;
  max = std::max(max, later.max);
  sumSquares += later.sumSquares;
  lo = std::min(lo, later.lo);
  hi = std::max(hi, later.hi);
}

double hbErrorStatistics::rmse() const { return count > 0 ? std::sqrt(sumSquares / double(count)) : 0.0; }

std::optional<double> hbErrorStatistics::psnr() const { return hi > lo ? psnr(hi - lo) : std::nullopt; }

std::optional<double> hbErrorStatistics::psnr(double peak) const {
  if (max == 0.0) return std::nullopt;
  return 20.0 * std::log10(peak / rmse());
}
