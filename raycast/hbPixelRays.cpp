#include "raycast/hbPixelRays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "raycast/hbRaySegment.h"

namespace {

double greatest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

} // namespace

hbPixelRays::hbPixelRays(const hbCamera& camera, int width, int height, const hbGeometry& geometry,
                         const hbScene::ClipBox& box)
    : camera_(camera), width_(width), height_(height), worldToCube_(glm::inverse(geometry.cubeToWorld())), box_(box) {
  const bool perspective = camera.projection == hbCamera::Projection::perspective;
  const glm::dvec3 axis = camera.viewAxis();
  const double tangent = std::tan(0.5 * glm::radians(camera.fieldOfView));
  if (perspective) slope_ = 2.0 * tangent / height;
  // Three rays near the middle, at most 45 degrees from the view axis, where nothing is lost by dividing.
  const double apart = 0.5 * height * (perspective ? std::min(1.0, 1.0 / tangent) : 1.0);
  const double middleX = 0.5 * width, middleY = 0.5 * height;
  const auto at = [&](double px, double py, glm::dvec3& origin, glm::dvec3& direction) {
    const hbRay ray = camera.ray(px, py, width, height);
    origin = glm::dvec3(worldToCube_ * glm::dvec4(ray.origin, 1.0));
    direction = glm::dvec3(worldToCube_ * glm::dvec4(ray.direction / glm::dot(ray.direction, axis), 0.0));
  };
  at(middleX, middleY, origin_, direction_);
  at(middleX + apart, middleY, originX_, directionX_);
  at(middleX, middleY + apart, originY_, directionY_);
  originX_ = (originX_ - origin_) / apart;
  originY_ = (originY_ - origin_) / apart;
  directionX_ = (directionX_ - direction_) / apart;
  directionY_ = (directionY_ - direction_) / apart;
  if (perspective)
    originX_ = originY_ = glm::dvec3(0.0);
  else
    directionX_ = directionY_ = glm::dvec3(0.0);
  origin_ -= middleX * originX_ + middleY * originY_;
  direction_ -= middleX * directionX_ + middleY * directionY_;
  toPixel_ = glm::inverse(perspective ? glm::dmat3(direction_, directionX_, directionY_)
                                      : glm::dmat3(direction_, originX_, originY_));

  const glm::dmat4 world = geometry.cubeToWorld();
  for (int d = 0; d < 3; ++d) toDistance_[d] = glm::dot(glm::dvec3(world[d]), axis);
  distanceOfCorner_ = glm::dot(glm::dvec3(world[3]) - camera.position, axis);
}

double hbPixelRays::stretch(double px, double py) const {
  const double x = slope_ * (px - 0.5 * width_), y = slope_ * (py - 0.5 * height_);
  return std::sqrt(1.0 + x * x + y * y);
}

double hbPixelRays::pixelSize(double distance) const {
  return camera_.projection == hbCamera::Projection::perspective ? slope_ * distance : camera_.height / height_;
}

glm::dvec2 hbPixelRays::pixel(const glm::dvec3& point) const {
  const glm::dvec3 h = toPixel_ * (point - origin_);
  return camera_.projection == hbCamera::Projection::perspective ? glm::dvec2(h.y, h.z) / h.x : glm::dvec2(h.y, h.z);
}

std::optional<hbPixelRays::Interval> hbPixelRays::clip(double px, double py) const {
  const glm::dvec3 o = origin(px, py), v = direction(px, py);
  const double reach = 1.0 + greatest(o), fastest = greatest(v);
  Interval in{0.0, std::numeric_limits<double>::infinity()};
  for (int d = 0; d < 3; ++d) {
    const double toLo = box_.lo[d] - o[d], toHi = box_.hi[d] - o[d];
    if (std::abs(v[d]) <= 1e-6 * fastest) { // along two faces: far from both the ray is inside or outside for good
      constexpr double kNear = 1e-3, kFar = 100.0;
      if (reach > kFar || std::abs(toLo) < kNear || std::abs(toHi) < kNear) return clipExactly(px, py);
      if (toLo > 0.0 || toHi < 0.0) return std::nullopt;
      continue;
    }
    const double inverse = 1.0 / v[d], a = toLo * inverse, b = toHi * inverse;
    in.enter = std::max(in.enter, std::min(a, b));
    in.leave = std::min(in.leave, std::max(a, b));
  }
  // Rounding moves either end by some 2^-52 reach / |v[d]|, which is below 1e-9 reach / fastest.
  if (std::abs(in.leave - in.enter) * fastest < 1e-6 * reach) return clipExactly(px, py);
  if (!(in.enter < in.leave)) return std::nullopt;
  return in;
}

std::optional<hbPixelRays::Interval> hbPixelRays::clipExactly(double px, double py) const {
  const auto segment = hb::clipToCube(camera_.ray(px, py, width_, height_), worldToCube_, box_.lo, box_.hi);
  if (!segment) return std::nullopt;
  const double shorter = 1.0 / stretch(px, py);
  return Interval{segment->enter * shorter, segment->leave * shorter};
}
