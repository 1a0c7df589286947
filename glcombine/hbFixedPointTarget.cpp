#include "glcombine/hbFixedPointTarget.h"

#include <algorithm>
#include <cmath>

std::int64_t hbFixedPointTarget::quantised(double value) const {
  const double inside = value > 0.0 ? std::min(value, 1.0) : 0.0; // NaN to 0
  return std::int64_t(std::nearbyint(inside * double(most_)));
}

void hbFixedPointTarget::add(double source) { steps_ = std::min(steps_ + quantised(source), most_); }

void hbFixedPointTarget::reverseSubtract(double source) {
  steps_ = std::max(steps_ - quantised(source), std::int64_t{0});
}

double hb::fixedPointLow(double least, double whole) { return whole > 0.0 ? std::min(least, least / whole) : least; }
