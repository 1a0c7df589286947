#include "fitting/hbFitLoss.h"

#include <algorithm>
#include <cmath>

double hbFitLoss::cost(double residual) const {
  const double size = std::abs(residual);
  if (kind == Kind::none || size <= threshold) return 0.5 * residual * residual;
  return threshold * (size - 0.5 * threshold);
}

double hbFitLoss::weight(double residual) const {
  const double size = std::abs(residual);
  return kind == Kind::none || size <= threshold ? 1.0 : threshold / size;
}

double hbFitLoss::thresholdOf(std::span<float> magnitudes) {
  if (magnitudes.empty()) return 0.0;
  const auto middle = magnitudes.begin() + std::ptrdiff_t(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.345 * 1.4826 * double(*middle);
}
