#include "scene/hbColorSpace.h"

#include <array>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace {
glm::dvec3 luvOfSrgb(const glm::dvec3& coded) { return hb::xyzToLuv(hb::linearToXyz(hb::srgbToLinear(coded))); }
glm::dvec3 labOfSrgb(const glm::dvec3& coded) { return hb::xyzToLab(hb::linearToXyz(hb::srgbToLinear(coded))); }
} // namespace

TEST(hbColorSpace, SrgbCurveHasItsKnownValues) {
  EXPECT_EQ(hb::srgbToLinear(0.0), 0.0);
  EXPECT_DOUBLE_EQ(hb::srgbToLinear(1.0), 1.0);
  EXPECT_DOUBLE_EQ(hb::linearToSrgb(1.0), 1.0);
  EXPECT_NEAR(hb::srgbToLinear(0.5), 0.21404114, 5e-9); // the published value has eight digits
  EXPECT_DOUBLE_EQ(hb::srgbToLinear(0.04), 0.04 / 12.92);
}

TEST(hbColorSpace, SrgbRoundTrips) {
  // At most 3e-8 at the join (stated in the header), elsewhere the rounding of two powers.
  for (int i = 0; i <= 4096; ++i) EXPECT_NEAR(hb::linearToSrgb(hb::srgbToLinear(i / 4096.0)), i / 4096.0, 3e-8) << i;
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(hb::linearToSrgb(hb::srgbToLinear(i / 255.0)), i / 255.0, 1e-14) << i;
}

TEST(hbColorSpace, LuvOfThePrimaries) {
  // Reference values (Lindbloom's calculator, D65) use a matrix and a white of more digits: both agree to 1e-4 in XYZ,
  // which is 0.05 in u* and v* (13 L* du', du' <= 5e-5 for these chromaticities).
  constexpr double kTolerance = 0.1;
  const std::array<std::array<glm::dvec3, 2>, 4> known{{{glm::dvec3(1, 0, 0), glm::dvec3(53.2408, 175.0151, 37.7564)},
                                                        {glm::dvec3(0, 1, 0), glm::dvec3(87.7347, -83.0776, 107.3985)},
                                                        {glm::dvec3(0, 0, 1), glm::dvec3(32.2970, -9.4054, -130.3423)},
                                                        {glm::dvec3(1, 1, 1), glm::dvec3(100.0, 0.0, 0.0)}}};
  for (const auto& [rgb, luv] : known)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(luvOfSrgb(rgb)[c], luv[c], kTolerance) << luv[0];
}

TEST(hbColorSpace, GraysHaveNoHue) {
  for (int i = 1; i <= 255; ++i) {
    const glm::dvec3 luv = luvOfSrgb(glm::dvec3(i / 255.0));
    // 13 L* <= 1300 times the rounding of u' and v', a few eps.
    EXPECT_NEAR(luv.y, 0.0, 1300 * 16 * 0x1p-53);
    EXPECT_NEAR(luv.z, 0.0, 1300 * 16 * 0x1p-53);
  }
  EXPECT_EQ(luvOfSrgb(glm::dvec3(0)), glm::dvec3(0));
  // Y = 0.18 (a photographer's gray): 116 * 0.18^(1/3) - 16.
  EXPECT_NEAR(hb::xyzToLuv(hb::linearToXyz(glm::dvec3(0.18))).x, 49.4961, 5e-5);
}

TEST(hbColorSpace, LabOfRed) {
  // As for L*u*v*: 500 df <= 500 * 1e-4 / (3 * 0.4^2).
  const glm::dvec3 lab = labOfSrgb({1, 0, 0});
  EXPECT_NEAR(lab.x, 53.2408, 0.1);
  EXPECT_NEAR(lab.y, 80.0925, 0.1);
  EXPECT_NEAR(lab.z, 67.2032, 0.1);
}

TEST(hbColorSpace, LabAndXyzRoundTrip) {
  for (const glm::dvec3 rgb : {glm::dvec3(0.9, 0.1, 0.4), glm::dvec3(0.001, 0.002, 0.0), glm::dvec3(1.0)}) {
    const glm::dvec3 xyz = hb::linearToXyz(rgb);
    // Cube and cube root: 3 eps each of values below 1.1, times the 7.787 slope near black at most.
    EXPECT_LT(glm::distance(hb::labToXyz(hb::xyzToLab(xyz)), xyz), 64 * 0x1p-53);
    EXPECT_LT(glm::distance(hb::xyzToLinear(xyz), rgb), 64 * 0x1p-53);
  }
}
