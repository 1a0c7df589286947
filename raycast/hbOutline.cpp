#include "raycast/hbOutline.h"

#include <algorithm>
#include <array>

#include <glm/common.hpp>

namespace {

/// The part of a convex polygon where a coordinate is at least (sign 1) or at most (sign -1) a bound.
/// Source: Sutherland, Hodgman, Reentrant Polygon Clipping.
std::vector<glm::dvec2> cut(const std::vector<glm::dvec2>& polygon, int axis, double sign, double bound) {
  std::vector<glm::dvec2> rest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double a = sign * (from[axis] - bound), b = sign * (to[axis] - bound);
    if (a >= 0.0) rest.push_back(from);
    if ((a >= 0.0) != (b >= 0.0)) rest.push_back(from + a / (a - b) * (to - from));
  }
  return rest;
}

} // namespace

std::vector<glm::dvec2> hb::outline(const hbPixelRays& rays) {
  const double right = rays.width() - 0.5, bottom = rays.height() - 0.5;
  const auto& [lo, hi] = rays.box();
  std::array<glm::dvec2, 8> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 point = glm::mix(lo, hi, glm::bvec3(corner & 1, corner >> 1 & 1, corner >> 2));
    // From nearer by than a thousandth of the box's depth it is seen too far off.
    constexpr double kNearest = 1e-3;
    if (rays.distance(point) < kNearest * std::abs(rays.distance(lo + hi - point)))
      return {{0.5, 0.5}, {right, 0.5}, {0.5, bottom}, {right, bottom}};
    corners[std::size_t(corner)] = rays.pixel(point);
  }
  std::vector<glm::dvec2> all;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int first = side << axis, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
      std::vector<glm::dvec2> face;
      for (const int corner : {first, first + u, first + u + v, first + v})
        face.push_back(corners[std::size_t(corner)]);
      face = cut(cut(cut(cut(face, 0, 1.0, 0.5), 0, -1.0, right), 1, 1.0, 0.5), 1, -1.0, bottom);
      all.insert(all.end(), face.begin(), face.end());
    }
  return all;
}
