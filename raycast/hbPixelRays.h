#pragma once

#include <optional>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/hbCamera.h"
#include "scene/hbScene.h"
#include "volume/hbGeometry.h"

/// The rays of a picture's pixels in the cube of a volume, or in a part of it. Point s of the ray through (px, py), as
/// hbCamera::ray() has them, is origin(px, py) + s direction(px, py), with s the distance from the camera along the
/// view axis. Both are affine in px and py, so that a ray takes a few operations and no root.
class hbPixelRays {
public:
  /// The part of a ray inside the box, in distances along the view axis: 0 <= enter < leave.
  struct Interval {
    double enter = 0.0, leave = 0.0;
  };

  /// The camera must be valid; `width` x `height` pixels. `box`: what of the cube is seen.
  hbPixelRays(const hbCamera& camera, int width, int height, const hbGeometry& geometry,
              const hbScene::ClipBox& box = {});

  glm::dvec3 origin(double px, double py) const { return origin_ + px * originX_ + py * originY_; }
  glm::dvec3 direction(double px, double py) const { return direction_ + px * directionX_ + py * directionY_; }

  /// World length of a ray per unit of distance along the view axis: 1 over the cosine of the angle between them.
  double stretch(double px, double py) const;

  /// The world size of a pixel at that distance along the view axis.
  double pixelSize(double distance) const;

  /// Where the ray meets the box, exactly where hb::clipToCube() says so: rays that only graze it are handed on to it.
  std::optional<Interval> clip(double px, double py) const;

  /// The distance along the view axis of a point of the cube.
  double distance(const glm::dvec3& point) const { return glm::dot(toDistance_, point) + distanceOfCorner_; }

  /// Where in the picture a point of the cube is seen; its distance must be positive in perspective.
  glm::dvec2 pixel(const glm::dvec3& point) const;

  const hbCamera& camera() const { return camera_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const glm::dmat4& worldToCube() const { return worldToCube_; }
  const hbScene::ClipBox& box() const { return box_; }

private:
  std::optional<Interval> clipExactly(double px, double py) const;

  hbCamera camera_;
  int width_, height_;
  glm::dmat4 worldToCube_;
  hbScene::ClipBox box_;
  glm::dvec3 origin_{0.0}, originX_{0.0}, originY_{0.0};
  glm::dvec3 direction_{0.0}, directionX_{0.0}, directionY_{0.0};
  glm::dmat3 toPixel_{1.0}; ///< A point, from the origin of pixel (0, 0)'s ray on, to (s, s px, s py) or (s, px, py).
  glm::dvec3 toDistance_{0.0};
  double distanceOfCorner_ = 0.0;
  double slope_ = 0.0; ///< Perspective: what a ray's slope to the view axis grows by from pixel to pixel.
};
