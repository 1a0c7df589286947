#include "scene/hbSampling.h"

#include <cmath>

#include <gtest/gtest.h>

namespace {

hbCamera along(const glm::dvec3& axis) {
  hbCamera camera;
  camera.position = -100.0 * axis;
  camera.up = std::abs(axis.z) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  return camera;
}

/// A box of 63 x 2 x 3 world units from the origin.
hbGeometry box() {
  hbGeometry g;
  g.size = {64, 5, 2};
  g.spacing = {1.0, 0.5, 3.0};
  return g;
}

} // namespace

TEST(hbSampling, ExtentIsThatOfTheBoxSeenFromTheCamera) {
  const auto x = hbSampling::extent(box(), along({1, 0, 0}));
  // Coordinates of about 100 in a handful of operations.
  EXPECT_NEAR(x.near, 100.0, 1e3 * 0x1p-52);
  EXPECT_NEAR(x.far, 163.0, 1e3 * 0x1p-52);
  const auto diagonal = hbSampling::extent(box(), along({0.6, 0.8, 0.0}));
  EXPECT_NEAR(diagonal.far - diagonal.near, 63 * 0.6 + 2 * 0.8, 1e3 * 0x1p-52);
  hbCamera inside = along({1, 0, 0});
  inside.position = {10, 0, 0};
  inside.target = {11, 0, 0};
  EXPECT_NEAR(hbSampling::extent(box(), inside).near, -10.0, 1e3 * 0x1p-52);
}

TEST(hbSampling, OneSampleAVoxelByDefault) {
  // The finest spacing is 0.5: 63 / 0.5 planes along x, exactly; 3 / 0.5 along z.
  const hbSampling sampling;
  EXPECT_EQ(sampling.planes(box(), along({1, 0, 0})), 126);
  EXPECT_EQ(sampling.planes(box(), along({0, 0, 1})), 6);
  EXPECT_DOUBLE_EQ(sampling.stepLength(box(), along({1, 0, 0})), 0.5);
  // Whole numbers of spacings that rounding makes a little more stay what they are: 63 * 0.1 / 0.1.
  hbGeometry decimal;
  decimal.size = {64, 64, 64};
  decimal.spacing = glm::dvec3(0.1);
  EXPECT_EQ(sampling.planes(decimal, along({1, 0, 0})), 63);
}

TEST(hbSampling, FlatAxesDoNotSetTheStep) {
  hbGeometry flat = box();
  flat.size.y = 1; // 0.5 thick
  EXPECT_EQ(hbSampling{}.planes(flat, along({1, 0, 0})), 63);
  EXPECT_EQ(hbSampling{}.planes(flat, along({0, 1, 0})), 1);
  flat.size = {1, 1, 1};
  EXPECT_EQ(hbSampling{}.planes(flat, along({1, 0, 0})), 2); // 1 thick, steps of 0.5
}

TEST(hbSampling, AsManyPlanesAsAskedFor) {
  hbSampling sampling;
  sampling.samples = 200;
  EXPECT_EQ(sampling.planes(box(), along({1, 0, 0})), 200);
  EXPECT_DOUBLE_EQ(sampling.stepLength(box(), along({1, 0, 0})), 63.0 / 200.0);
}

TEST(hbSampling, PlanesAreBounded) {
  hbGeometry thin;
  thin.size = {std::int64_t{1} << 40, 2, 2};
  EXPECT_EQ(hbSampling{}.planes(thin, along({1, 0, 0})), hbSampling::kMaxSamples);
}
