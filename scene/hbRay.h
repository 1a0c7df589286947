#pragma once

#include <glm/vec3.hpp>

/// A half-line in world space.
struct hbRay {
  glm::dvec3 origin{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0}; ///< Unit length, so that a ray parameter is a world distance.
};
