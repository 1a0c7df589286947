#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "tests/raycast/hbDvrBounds.h"

/// Scenes whose light is placed aside, on the viewer's side of the surfaces of a linear field.
inline hbShading placedLight(const hbGeometry& g, const hbCamera& camera, const glm::dvec3& slopes) {
  const glm::dmat4 toWorld = g.cubeToWorld();
  const glm::dvec3 normal = glm::normalize(glm::transpose(glm::dmat3(glm::inverse(toWorld))) * slopes);
  const double side = glm::dot(normal, camera.viewAxis()) < 0.0 ? 1.0 : -1.0;
  hbShading shading;
  shading.lights = {
      {glm::dvec3(toWorld * glm::dvec4(0.5, 0.5, 0.5, 1.0)) + 5.0 * side * normal + glm::dvec3(1.0, 0.5, -1.0),
       {1.0, 0.5, 2.0}}};
  return shading;
}

/// How far the channels of a planewise DVR picture of a linear field, lit by its gradient, move with what is rounded.
class hbLitBounds {
public:
  /// `slopes`: the field's, in the cube. All lights are to be on one side of its surfaces as seen from the volume, and
  /// so is the viewer; else a rounding could turn light into shade.
  hbLitBounds(const hbPlaneRays& rays, const glm::dvec3& slopes) : rays_(rays), bounds_(rays) {
    const hbGeometry& g = rays.field().geometry();
    const hbScene& scene = rays.scene();
    const glm::dmat3 toWorld(glm::transpose(glm::dmat3(rays.worldToCube())));
    const glm::dvec3 gradient = toWorld * slopes;
    const double length = glm::length(gradient);
    // Central differences are of two values, a sample spacing apart at the least.
    for (int d = 0; d < 3; ++d) perDifference_ += glm::length(toWorld[d]) / g.cubeSpacing()[d];
    if (scene.gradientOpacity) {
      const auto [lo, hi] = *scene.gradientOpacity;
      shown_ = (length - lo) / (hi - lo);
      EXPECT_GE(shown_, 0.25);
      EXPECT_LE(shown_, 1.0);
      perShown_ = 1.0 / (hi - lo);
    }
    if (!scene.shading) return;
    const hbShading& shading = *scene.shading;
    const glm::dvec3 normal = gradient / length;
    // The half vector of two unit vectors is at least as long as their cosines with the normal together.
    const double half = leastCosines(normal);
    // A unit vector turns by at most twice what its vector moves over its length. Cosines move as much as directions
    // do, and powers of them their exponent (1 or more) times as much.
    perTurn_ = 2.0 / length;
    EXPECT_GE(shading.shininess, 1.0);
    double lights = shading.lights.empty() ? 1.0 : 0.0;
    for (const hbShading::Light& light : shading.lights)
      lights += std::max(light.colour.r, std::max(light.colour.g, light.colour.b));
    brightest_ = std::max(1.0, shading.ambient + (shading.diffuse + shading.specular) * lights);
    perNormal_ = (shading.diffuse + shading.shininess * shading.specular) * lights;
    perDirection_ = (shading.diffuse + shading.shininess * shading.specular * 4.0 / half) * lights;
  }

  /// Of a channel of this pixel, where values are off by `perValue`, differences of two by `perDifference` and
  /// directions by `perDirection`, and where light is added up in 32 bits if that is so.
  double channel(std::size_t pixel, double perValue, double perDifference, double perDirection, bool isInFloats) const {
    const double slope = perDifference_ * perDifference;
    // What is added of a piece's light, and so what is let through of that behind it, moves by as much of it as its
    // depth does of itself.
    const double opacity = 2.0 * brightest_ * slope * perShown_ / shown_;
    const double unlit = bounds_.channel(pixel, perValue) + (isInFloats ? bounds_.inFloats(pixel) : 0.0);
    return brightest_ * unlit + opacity + perNormal_ * slope * perTurn_ + perDirection_ * perDirection;
  }

private:
  /// The least cosine of the normal with the way to the viewer and the least one with that to a light: they are affine
  /// in directions and places before those are made of length 1, and have one sign if they do in all corners.
  double leastCosines(const glm::dvec3& normal) const {
    const hbScene& scene = rays_.scene();
    const glm::dmat4 toWorld = glm::inverse(rays_.worldToCube());
    const double side = glm::dot(normal, scene.camera->viewAxis()) < 0.0 ? 1.0 : -1.0;
    double viewer = 1.0, light = 1.0;
    for (const double x : {0.0, double(scene.width)})
      for (const double y : {0.0, double(scene.height)})
        viewer =
            std::min(viewer, -side * glm::dot(normal, scene.camera->ray(x, y, scene.width, scene.height).direction));
    for (const hbShading::Light& one : scene.shading->lights)
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place(toWorld * glm::dvec4(corner & 1, corner >> 1 & 1, corner >> 2, 1.0));
        light = std::min(light, side * glm::dot(normal, glm::normalize(one.position - place)));
      }
    EXPECT_GT(viewer, 0.01);
    EXPECT_GT(light, 0.01);
    return viewer + light;
  }

  const hbPlaneRays& rays_;
  hbDvrBounds bounds_;
  double perDifference_ = 0.0; ///< Of the gradient.
  double shown_ = 1.0, perShown_ = 0.0;
  double brightest_ = 1.0;
  double perTurn_ = 0.0, perNormal_ = 0.0, perDirection_ = 0.0;
};
