#include "raycast/hbNominalSamples.h"

#include <gtest/gtest.h>

namespace {

/// A cube of edge 2, seen from the front by parallel rays in a picture of `height` world units.
hbScene front(const hbGeometry& geometry, double height) {
  hbScene scene;
  scene.width = scene.height = 10;
  scene.sampling.samples = 8;
  scene.camera = hbCamera::framing(geometry, 0.0, 0.0, hbCamera::Projection::orthographic);
  scene.camera->height = height;
  return scene;
}

hbGeometry cube() {
  hbGeometry geometry;
  geometry.size = {3, 3, 3};
  return geometry;
}

} // namespace

TEST(hbNominalSamples, AreTheSamplesOfEveryRayThatMeetsTheVolume) {
  // All 100 rays go through the depth of 2, which has 8 samples.
  EXPECT_NEAR(hb::nominalSamples(cube(), front(cube(), 2.0)), 100.0 * 8.0, 1e-9);
  // Half the picture's sides: the 5 x 5 rays in the middle.
  EXPECT_NEAR(hb::nominalSamples(cube(), front(cube(), 4.0)), 36.0 * 8.0, 1e-9);
}

TEST(hbNominalSamples, DoNotDependOnHowFineTheVolumeIs) {
  hbGeometry fine = cube();
  fine.size = {5, 5, 5};
  fine.spacing = glm::dvec3(0.5);
  EXPECT_NEAR(hb::nominalSamples(fine, front(cube(), 2.0)), 800.0, 1e-9);
}
