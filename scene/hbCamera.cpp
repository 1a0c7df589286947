#include "scene/hbCamera.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "volume/hbError.h"

namespace {

/// The camera's axes in world space: right and up in the picture, forward into it.
struct Axes {
  glm::dvec3 right, up, forward;
};

Axes axesOf(const hbCamera& camera) {
  Axes axes;
  axes.forward = camera.viewAxis();
  axes.right = glm::normalize(glm::cross(axes.forward, glm::normalize(camera.up)));
  axes.up = glm::cross(axes.right, axes.forward);
  return axes;
}

double halfHeightAtUnitDistance(double fieldOfView) { return std::tan(0.5 * glm::radians(fieldOfView)); }

} // namespace

glm::dvec3 hbCamera::viewAxis() const { return glm::normalize(target - position); }

hbCamera::Rays::Rays(const hbCamera& camera)
    : projection_(camera.projection), position_(camera.position),
      scale_(projection_ == Projection::orthographic ? 0.5 * camera.height
                                                     : halfHeightAtUnitDistance(camera.fieldOfView)) {
  const Axes axes = axesOf(camera);
  right_ = axes.right;
  up_ = axes.up;
  forward_ = axes.forward;
}

hbRay hbCamera::Rays::at(double px, double py, int width, int height) const {
  // Picture coordinates in halves of its height, from its centre, y upwards.
  const double x = (2.0 * px - width) / height;
  const double y = (height - 2.0 * py) / height;
  const glm::dvec3 offset = scale_ * (x * right_ + y * up_);
  if (projection_ == Projection::orthographic) return {position_ + offset, forward_};
  return {position_, glm::normalize(forward_ + offset)};
}

hbRay hbCamera::ray(double px, double py, int pictureWidth, int pictureHeight) const {
  return Rays(*this).at(px, py, pictureWidth, pictureHeight);
}

void hbCamera::validate(const std::string& what) const {
  const auto finite = [&](const char* name, const glm::dvec3& v) {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      throw hbError(fmt::format("{}: {}: expected finite numbers, found ({}, {}, {})", what, name, v.x, v.y, v.z));
  };
  finite("position", position);
  finite("target", target);
  finite("up", up);
  const double distance = glm::length(target - position);
  if (!(distance > 0.0) || !std::isfinite(distance))
    throw hbError(
        fmt::format("{}: target: expected a point a finite distance from the position, found {}", what, distance));
  const double upLength = glm::length(up);
  if (!(upLength > 0.0) || !std::isfinite(upLength))
    throw hbError(fmt::format("{}: up: expected a vector of finite length, found length {}", what, upLength));
  // The sine of the angle between the two; below this the picture's rotation would be rounding error.
  constexpr double kLeastSine = 1e-6;
  if (!(glm::length(glm::cross(viewAxis(), up / upLength)) > kLeastSine))
    throw hbError(fmt::format("{}: up: expected a vector not parallel to the view axis, found ({}, {}, {})", what, up.x,
                              up.y, up.z));
  if (!(fieldOfView > 0.0 && fieldOfView < 180.0))
    throw hbError(fmt::format("{}: fieldOfView: expected degrees inside (0, 180), found {}", what, fieldOfView));
  if (!(height > 0.0) || !std::isfinite(height))
    throw hbError(fmt::format("{}: height: expected a positive finite number, found {}", what, height));
}

hbCamera hbCamera::framing(const hbGeometry& geometry, double azimuthDegrees, double elevationDegrees,
                           Projection projection, double aspect, double zoom) {
  if (!std::isfinite(azimuthDegrees))
    throw hbError(fmt::format("camera: azimuth: expected finite degrees, found {}", azimuthDegrees));
  if (!(std::abs(elevationDegrees) <= 90.0))
    throw hbError(fmt::format("camera: elevation: expected degrees in [-90, 90], found {}", elevationDegrees));
  if (!(aspect > 0.0) || !std::isfinite(aspect))
    throw hbError(fmt::format("camera: aspect: expected a positive finite number, found {}", aspect));
  if (!(zoom > 0.0) || !std::isfinite(zoom))
    throw hbError(fmt::format("camera: zoom: expected a positive finite number, found {}", zoom));

  const double azimuth = glm::radians(std::remainder(azimuthDegrees, 360.0));
  const double elevation = glm::radians(elevationDegrees);
  const double sa = std::sin(azimuth), ca = std::cos(azimuth), se = std::sin(elevation), ce = std::cos(elevation);
  const glm::dvec3 back{sa * ce, -ca * ce, se}; // from the centre to the camera
  const glm::dvec3 right{ca, sa, 0.0};
  const glm::dvec3 up{-sa * se, ca * se, ce}; // world z seen from there; also defined looking straight down

  const glm::dmat4 world = geometry.cubeToWorld();
  const double slope = halfHeightAtUnitDistance(kDefaultFieldOfView);
  double halfHeight = 0.0; // orthographic: so that every corner is in view
  double distance = 0.0;   // perspective: likewise
  double depth = 0.0;      // of the box, from its centre
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 p{0.0}; // relative to the centre
    for (int d = 0; d < 3; ++d) p += ((corner >> d & 1) != 0 ? 0.5 : -0.5) * glm::dvec3(world[d]);
    const double reach = kFramingMargin * std::max(std::abs(glm::dot(p, right)) / aspect, std::abs(glm::dot(p, up)));
    const double nearness = glm::dot(p, back);
    halfHeight = std::max(halfHeight, reach);
    distance = std::max(distance, nearness + reach / slope);
    depth = std::max(depth, nearness);
  }
  // A corner of a strongly sheared box can lie on the view axis and be the nearest by far: stay outside the box.
  distance = std::max(distance, 1.001 * depth);

  hbCamera camera;
  camera.projection = projection;
  camera.target = glm::dvec3(world * glm::dvec4(0.5, 0.5, 0.5, 1.0));
  camera.position = camera.target + distance * back;
  camera.up = up;
  camera.fieldOfView = 2.0 * glm::degrees(std::atan(slope / zoom));
  camera.height = 2.0 * halfHeight / zoom;
  camera.validate("camera");
  // Beside large world coordinates the way to a small box is lost in rounding.
  if (!(glm::distance(camera.position - camera.target, distance * back) <= 1e-3 * distance))
    throw hbError(
        fmt::format("camera: expected a volume large enough for its place, found ({}, {}, {}) seen from {} away",
                    camera.target.x, camera.target.y, camera.target.z, distance));
  return camera;
}
