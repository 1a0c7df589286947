#include "raycast/hbPixelRays.h"

#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

namespace {

/// Every pixel's ray, and whether and where it meets the box, as hbCamera and hb::clipToCube() have it.
int expectTheCamerasRays(const hbCamera& camera, const hbGeometry& g, int width, int height,
                         const hbScene::ClipBox& box = {}) {
  const hbPixelRays rays(camera, width, height, g, box);
  const glm::dmat4 toCube = glm::inverse(g.cubeToWorld());
  const glm::dvec3 axis = camera.viewAxis();
  int met = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const hbRay ray = camera.ray(px, py, width, height);
      const double cosine = glm::dot(ray.direction, axis);
      EXPECT_NEAR(rays.stretch(px, py) * cosine, 1.0, 1e-12);
      const auto expected = hb::clipToCube(ray, toCube, box.lo, box.hi);
      const auto found = rays.clip(px, py);
      EXPECT_EQ(found.has_value(), expected.has_value()) << x << " " << y;
      if (!found || !expected) continue;
      ++met;
      for (const auto& [here, there] : {std::pair(found->enter, expected->enter), {found->leave, expected->leave}}) {
        const glm::dvec3 mine = rays.origin(px, py) + here * rays.direction(px, py), theirs = expected->at(there);
        // A dozen operations on numbers up to the eye's distance.
        const double scale = 1.0 + glm::length(rays.origin(px, py)) + glm::length(here * rays.direction(px, py));
        EXPECT_LE(glm::distance(mine, theirs), 1e-12 * scale);
        const double fromAxis = glm::dot(glm::dvec3(g.cubeToWorld() * glm::dvec4(mine, 1.0)) - camera.position, axis);
        EXPECT_NEAR(rays.distance(mine), fromAxis, 1e-12 * scale * (1.0 + glm::length(g.extent())));
        EXPECT_NEAR(here, fromAxis, 1e-12 * scale * (1.0 + glm::length(g.extent())));
        // Seen where it came from, as far as its distance is known.
        if (here > 1e-3) {
          EXPECT_LE(glm::distance(rays.pixel(mine), glm::dvec2(px, py)), 1e-6 * scale);
        }
      }
    }
  return met;
}

} // namespace

TEST(hbPixelRays, AreTheCamerasRaysInTheCube) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward(), box({9, 1, 1}, {3.0, 1.0, 0.5})})
    for (const hbCamera& camera : cameras(g))
      for (const hbScene::ClipBox& clip : clipBoxes()) expectTheCamerasRays(camera, g, 17, 12, clip);
}

// Rays that lie in a face, along edges, or touch one belong to the cube or not by the last bit.
TEST(hbPixelRays, GrazeTheCubeAsClippingDoes) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  for (const Projection projection : {Projection::orthographic, Projection::perspective})
    for (const double elevation : {0.0, 90.0, 45.0}) {
      hbCamera camera = hbCamera::framing(g, 0.0, elevation, projection);
      camera.height = 8.0 / 7.0; // pixel centres on two faces
      EXPECT_GT(expectTheCamerasRays(camera, g, 8, 8), 0);
      hbScene::ClipBox half;
      half.hi = glm::dvec3(0.5); // and on faces in the middle
      EXPECT_GT(expectTheCamerasRays(camera, g, 9, 9, half), 0);
      camera.position = {0.5, -0.25, 1.0}; // in the plane of a face
      camera.target = {0.5, 0.5, 1.0};
      camera.up = {0.0, 0.0, 1.0};
      EXPECT_GT(expectTheCamerasRays(camera, g, 9, 9), 0);
    }
}

// Outermost pixels whose rays just touch an edge of the cube: they meet it or not by the last bit.
TEST(hbPixelRays, TouchEdgesAsClippingDoes) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  for (int degrees = 1; degrees < 360; degrees += 2) {
    hbCamera camera = hbCamera::framing(g, degrees, 0.0, Projection::orthographic);
    const double angle = glm::radians(double(degrees)),
                 half = 0.5 * (std::abs(std::sin(angle)) + std::abs(std::cos(angle)));
    camera.height = half * 2.0 * 7.0 / 6.0; // pixel centres at -half, ..., half
    EXPECT_GT(expectTheCamerasRays(camera, g, 7, 7), 0);
  }
}

TEST(hbPixelRays, AreRightFromFarAwayAndForWideAngles) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  hbCamera camera = hbCamera::framing(g, 0.0, 0.0, Projection::orthographic);
  camera.position -= 1000.0 * camera.viewAxis();
  EXPECT_GT(expectTheCamerasRays(camera, g, 9, 9), 0);
  camera.projection = Projection::perspective;
  camera.fieldOfView = 0.06;
  EXPECT_GT(expectTheCamerasRays(camera, g, 9, 9), 0);
  camera.position = {0.5, 0.2, 0.5};
  camera.fieldOfView = 179.0;
  EXPECT_EQ(expectTheCamerasRays(camera, g, 9, 9), 81);
}

TEST(hbPixelRays, KnowThePixelsSizes) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  hbCamera camera = hbCamera::framing(g);
  camera.fieldOfView = 90.0;
  EXPECT_NEAR(hbPixelRays(camera, 10, 20, g).pixelSize(3.0), 2.0 * 3.0 / 20.0, 1e-14);
  camera.projection = Projection::orthographic;
  camera.height = 5.0;
  EXPECT_EQ(hbPixelRays(camera, 10, 20, g).pixelSize(3.0), 0.25);
}
