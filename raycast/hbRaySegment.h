#pragma once

#include <optional>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scene/hbRay.h"

/// The part of a ray inside a volume: a world-space parameter interval, and the line in the volume's cube.
struct hbRaySegment {
  glm::dvec3 origin{0.0};    ///< The ray's origin in cube coordinates.
  glm::dvec3 direction{0.0}; ///< Cube coordinates per unit of world length.
  double enter = 0.0;        ///< World distance from the ray's origin to where it enters the cube; at least 0.
  double leave = 0.0;        ///< ... and to where it leaves it; greater than enter.

  double length() const { return leave - enter; }
  glm::dvec3 at(double distance) const { return origin + distance * direction; }
};

namespace hb {

/// Clips a ray (from its origin on) to the unit cube of a volume, or to a part of it; none where it misses or only
/// touches it. `worldToCube` is the inverse of hbGeometry::cubeToWorld().
std::optional<hbRaySegment> clipToCube(const hbRay& ray, const glm::dmat4& worldToCube,
                                       const glm::dvec3& lo = glm::dvec3(0.0), const glm::dvec3& hi = glm::dvec3(1.0));

} // namespace hb
