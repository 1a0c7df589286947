#include "raycast/hbPlaneRays.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

// hbPlaneCompositorTest holds the planes and pictures against ray casting.
TEST(hbPlaneRays, NoPixelOutsideAPlanesWindowSeesTheVolumeOnIt) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward(), box({9, 1, 5}, {1.0, 0.3, 2.0})}) {
    const hbSparseGrid grid = gridOf(g, 2, {waves});
    std::int64_t outside = 0;
    std::vector<hbCamera> all = cameras(g);
    hbCamera onPlane; // an odd number of planes has one through the middle of the volume
    onPlane.position = glm::dvec3(g.cubeToWorld() * glm::dvec4(0.5, 0.5, 0.5, 1.0));
    onPlane.target = onPlane.position + glm::dvec3(0.3, 1.0, 0.2);
    all.push_back(onPlane);
    for (const hbCamera& camera : all) {
      const hbPlaneRays rays(grid, sceneOf(hbMode::xray, camera, 19, 13));
      for (int i = 0; i < rays.planes(); ++i) {
        const hbPlaneRays::Window window = rays.plane(i).window;
        for (int y = 0; y < 13; ++y)
          for (int x = 0; x < 19; ++x) {
            const hbPlaneRays::Ray& ray = rays.rays()[std::size_t(x + 19 * y)];
            const bool isIn =
                window.x <= x && x < window.x + window.width && window.y <= y && y < window.y + window.height;
            EXPECT_TRUE(isIn || i < ray.first || i > ray.last) << i << " " << x << " " << y;
            outside += !isIn;
          }
      }
    }
    EXPECT_GT(outside, 1000);
  }
}

TEST(hbPlaneRays, PointsOfRaysLieOnTheirPlanes) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  for (const hbCamera& camera : cameras(g)) {
    const hbPlaneRays rays(grid, sceneOf(hbMode::xray, camera, 19, 13));
    for (const int i : {0, rays.planes() - 1})
      for (const std::size_t pixel : {std::size_t{0}, std::size_t{100}, std::size_t{19 * 13 - 1}}) {
        const hbPlaneRays::Plane plane = rays.plane(i);
        const glm::dvec3 expected =
            plane.corner + (double(pixel % 19) + 0.5) * plane.right + (double(pixel / 19) + 0.5) * plane.down;
        const glm::dvec3 found = rays.at(pixel, i);
        if (rays.rays()[pixel].last < rays.rays()[pixel].first) continue; // it has no cosine
        const double size =
            glm::length(plane.corner) + 19.0 * glm::length(plane.right) + 13.0 * glm::length(plane.down);
        for (int d = 0; d < 3; ++d) EXPECT_NEAR(found[d], expected[d], 64.0 * 0x1p-52 * size) << i << " " << pixel;
      }
  }
}
