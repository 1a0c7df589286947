#include "scene/hbSampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace {

/// Half the length of the world box's shadow on a line along the unit vector `axis`.
double halfExtent(const hbGeometry& geometry, const glm::dvec3& axis) {
  const glm::dvec3 edges = geometry.extent();
  double half = 0.0;
  for (int d = 0; d < 3; ++d) half += 0.5 * edges[d] * std::abs(glm::dot(geometry.direction[d], axis));
  return half;
}

} // namespace

hbSampling::Extent hbSampling::extent(const hbGeometry& geometry, const hbCamera& camera) {
  const glm::dvec3 axis = camera.viewAxis();
  const glm::dvec3 centre(geometry.cubeToWorld() * glm::dvec4(0.5, 0.5, 0.5, 1.0));
  const double middle = glm::dot(centre - camera.position, axis);
  const double half = halfExtent(geometry, axis);
  return {middle - half, middle + half};
}

int hbSampling::planes(const hbGeometry& geometry, const hbCamera& camera) const {
  if (samples > 0) return samples;
  double finest = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d)
    if (!geometry.isFlat(d)) finest = std::min(finest, geometry.spacing[d]);
  if (!std::isfinite(finest)) finest = std::min({geometry.spacing.x, geometry.spacing.y, geometry.spacing.z});
  // A whole number of spacings should not become one more by rounding: about ten operations in 64 bits.
  constexpr double kRounding = 1e-14;
  const double count = std::ceil(2.0 * halfExtent(geometry, camera.viewAxis()) / finest * (1.0 - kRounding));
  return int(std::clamp(count, 1.0, double(kMaxSamples)));
}

double hbSampling::stepLength(const hbGeometry& geometry, const hbCamera& camera) const {
  return 2.0 * halfExtent(geometry, camera.viewAxis()) / planes(geometry, camera);
}
