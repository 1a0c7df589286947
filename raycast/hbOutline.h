#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "raycast/hbPixelRays.h"

namespace hb {

/// Points of the picture whose convex hull holds every pixel centre that sees the rays' box: the corners of what of its
/// faces lies between the outermost pixel centres. Where a part of the box is beside or behind the camera, simply
/// those four centres. Empty where the box is out of the picture.
std::vector<glm::dvec2> outline(const hbPixelRays& rays);

} // namespace hb
