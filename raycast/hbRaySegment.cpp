#include "raycast/hbRaySegment.h"

#include <algorithm>
#include <limits>

std::optional<hbRaySegment> hb::clipToCube(const hbRay& ray, const glm::dmat4& worldToCube, const glm::dvec3& lo,
                                           const glm::dvec3& hi) {
  hbRaySegment segment;
  segment.origin = glm::dvec3(worldToCube * glm::dvec4(ray.origin, 1.0));
  segment.direction = glm::dvec3(worldToCube * glm::dvec4(ray.direction, 0.0));
  segment.leave = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d) {
    const double o = segment.origin[d], v = segment.direction[d];
    if (v == 0.0) {
      if (o < lo[d] || o > hi[d]) return std::nullopt;
      continue;
    }
    const double a = (lo[d] - o) / v, b = (hi[d] - o) / v;
    segment.enter = std::max(segment.enter, std::min(a, b));
    segment.leave = std::min(segment.leave, std::max(a, b));
  }
  if (!(segment.enter < segment.leave)) return std::nullopt;
  return segment;
}
