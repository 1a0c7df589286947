#include "raycast/hbOutline.h"

#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>

#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

TEST(hbOutline, HoldsWhatIsSeen) {
  int whole = 0;
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()})
    for (hbCamera camera : cameras(g))
      for (const hbScene::ClipBox& clip : clipBoxes()) {
        camera.fieldOfView /= 1.3;
        camera.height /= 1.3;
        const hbPixelRays rays(camera, 24, 18, g, clip);
        const std::vector<glm::dvec2> outline = hb::outline(rays);
        whole += outline.size() == 4 ? 1 : 0;
        for (const glm::dvec2& p : outline) {
          EXPECT_GE(std::min(p.x, p.y), 0.5 - 1e-9);
          EXPECT_LE(std::max(p.x - 23.5, p.y - 17.5), 1e-9);
        }
        // In a convex hull: no line through the point has all of it on one side.
        for (int y = 0; y < 18; ++y)
          for (int x = 0; x < 24; ++x) {
            if (!rays.clip(x + 0.5, y + 0.5)) continue;
            for (int degrees = 0; degrees < 360; degrees += 5) {
              const double angle = glm::radians(double(degrees));
              const glm::dvec2 way(std::cos(angle), std::sin(angle));
              double farthest = -1e300;
              for (const glm::dvec2& p : outline)
                farthest = std::max(farthest, glm::dot(way, p - glm::dvec2(x + 0.5, y + 0.5)));
              ASSERT_GE(farthest, -1e-9);
            }
          }
      }
  EXPECT_GT(whole, 0);
  hbCamera away = hbCamera::framing(box({9, 9, 9}, {1.0, 1.0, 1.0}), 0.0, 0.0);
  away.target = away.position + glm::dvec3(1.0, 1.0, 0.0);
  away.fieldOfView = 10.0;
  EXPECT_TRUE(hb::outline(hbPixelRays(away, 24, 18, box({9, 9, 9}, {1.0, 1.0, 1.0}))).empty());
}
