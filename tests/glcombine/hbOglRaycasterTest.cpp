#include "glcombine/hbOglRaycaster.h"

#include <cmath>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "raycast/hbRaycaster.h"
#include "tests/glcombine/hbGlBounds.h"
#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

TEST(hbOglRaycaster, XrayAndMipAreThePlanewisePicturesOfTheCombination) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbCombinationSparseGrid grid(gridOf(g, 3, {waves}));
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        hbScene scene = sceneOf(mode, camera, 19, 13);
        scene.sampling.kind = hbSampling::Kind::planewise;
        const hbPicture expected = hbRaycaster(grid, scene).render();
        const hbPicture found = hbOglRaycaster(*context, grid, scene, {}).render();
        EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
        const std::vector<float> ys = channel(found, "Y"), exact = channel(expected, "Y");
        // Both are as far from the exact combination as their engines: twice.
        const double perValue = 2.0 * hbGlBounds(grid).floats();
        const double longest = glm::length(g.extent()) + scene.sampling.stepLength(g, camera) * 16.0;
        for (std::size_t i = 0; i < ys.size(); ++i)
          EXPECT_NEAR(ys[i], exact[i], perValue * (mode == hbMode::xray ? longest : 1.0) + 0x1p-22 * std::abs(exact[i]))
              << i;
      }
  }
}

// Of a linear field, whose surfaces are planes wherever they are cut.
TEST(hbOglRaycaster, IsoSurfacesAreThePlanewiseOnes) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbGeometry g = awkward();
  const hbCombinationSparseGrid grid(
      gridOf(g, 2, {[](const glm::dvec3& p) { return p.x + 2.0 * p.y + 3.0 * p.z - 2.7; }}));
  int surfaces = 0;
  for (const hbCamera& camera : cameras(g)) {
    hbScene scene = sceneOf(hbMode::iso, camera, 19, 13);
    scene.sampling.kind = hbSampling::Kind::planewise;
    const hbPicture expected = hbRaycaster(grid, scene).render();
    const hbPicture found = hbOglRaycaster(*context, grid, scene, {}).render();
    EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const auto i = std::size_t(x + scene.width * y);
        if (channel(expected, "A")[i] == 0.0F) continue;
        ++surfaces;
        const hbRay ray = camera.ray(x + 0.5, y + 0.5, scene.width, scene.height);
        const glm::dvec3 way(glm::inverse(g.cubeToWorld()) * glm::dvec4(ray.direction, 0.0));
        const double slope = std::abs(glm::dot(way, glm::dvec3(1.0, 2.0, 3.0))); // along the ray
        // Both ends of the step between two planes are off by as much as a value is, in either picture.
        const double z = channel(expected, "Z")[i], tolerance = 4.0 * hbGlBounds(grid).floats() / slope;
        EXPECT_NEAR(channel(found, "Z")[i], z, tolerance + 0x1p-22 * std::abs(z)) << x << " " << y;
      }
  }
  EXPECT_GT(surfaces, 500);
}
