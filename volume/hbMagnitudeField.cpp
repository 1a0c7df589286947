#include "volume/hbMagnitudeField.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

void hbMagnitudeField::values(const hbPoints& points, int, std::span<float> out) const {
  const hbValueMap map = vector_->valueMap();
  std::vector<float> part(points.size());
  std::vector<double> sum(points.size());
  for (int c = 0; c < vector_->components(); ++c) {
    vector_->values(points, c, part);
    for (std::size_t i = 0; i < part.size(); ++i) sum[i] += map.toTrue(part[i]) * map.toTrue(part[i]);
  }
  std::transform(sum.begin(), sum.end(), out.begin(), [](double s) { return float(std::sqrt(s)); });
}

void hbMagnitudeField::gradients(const hbPoints& points, int, std::span<float> out, const hbGradients& gradient) const {
  const hbValueMap map = vector_->valueMap();
  const std::size_t n = points.size();
  std::vector<float> part(n), dx(n), dy(n), dz(n);
  std::vector<double> sum(n);
  std::vector<glm::dvec3> slopes(n, glm::dvec3(0.0));
  for (int c = 0; c < vector_->components(); ++c) {
    vector_->gradients(points, c, part, {dx, dy, dz});
    for (std::size_t i = 0; i < n; ++i) {
      const double v = map.toTrue(part[i]);
      sum[i] += v * v;
      slopes[i] += v * map.scale * glm::dvec3(dx[i], dy[i], dz[i]);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double length = std::sqrt(sum[i]);
    const glm::dvec3 g = length > 0.0 ? slopes[i] / length : glm::dvec3(0.0);
    out[i] = float(length);
    gradient.dx[i] = float(g.x);
    gradient.dy[i] = float(g.y);
    gradient.dz[i] = float(g.z);
  }
}

hbRange hbMagnitudeField::range(const hbBox& box, int) const {
  const hbValueMap map = vector_->valueMap();
  double lo = 0.0, hi = 0.0;
  for (int c = 0; c < vector_->components(); ++c) {
    const hbRange part = vector_->range(box, c);
    const double a = map.toTrue(part.lo), b = map.toTrue(part.hi);
    const double least = a <= 0.0 && b >= 0.0 ? 0.0 : std::min(std::abs(a), std::abs(b)),
                 most = std::max(std::abs(a), std::abs(b));
    lo += least * least;
    hi += most * most;
  }
  // Rounded once to a float: one step outwards encloses it.
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {std::max(0.0F, std::nextafter(float(std::sqrt(lo)), -kInfinity)),
          std::nextafter(float(std::sqrt(hi)), kInfinity)};
}
