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

TEST(hbColorSpace, HsvOfKnownColoursAndRoundTrip) {
  EXPECT_EQ(hb::rgbToHsv({1, 0, 0}), glm::dvec3(0, 1, 1));
  EXPECT_EQ(hb::rgbToHsv({0, 0.5, 0}), glm::dvec3(2.0 / 6.0, 1, 0.5));
  EXPECT_EQ(hb::rgbToHsv({0, 1, 1}), glm::dvec3(0.5, 1, 1));
  EXPECT_EQ(hb::rgbToHsv({1, 0, 1}), glm::dvec3(5.0 / 6.0, 1, 1));
  EXPECT_EQ(hb::rgbToHsv({0.25, 0.25, 0.25}), glm::dvec3(0, 0, 0.25));
  EXPECT_EQ(hb::rgbToHsv({0, 0, 0}), glm::dvec3(0));
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const glm::dvec3 rgb = glm::dvec3(i % 9, i / 9 % 9, i / 81) / 8.0;
    const glm::dvec3 hsv = hb::rgbToHsv(rgb);
    EXPECT_GE(hsv.x, 0.0);
    EXPECT_LE(hsv.x, 1.0);
    // Six times a hue below 1 has an error of 6 half units of 2^-53, and a few more roundings of numbers up to 6.
    EXPECT_LT(glm::distance(hb::hsvToRgb(hsv), rgb), 32 * 0x1p-53) << i;
  }
}

TEST(hbColorSpace, MshAndLabRoundTrip) {
  for (const glm::dvec3 rgb : {glm::dvec3(0.9, 0.1, 0.4), glm::dvec3(0.2, 0.3, 0.7), glm::dvec3(0.1, 0.9, 0.1)}) {
    const glm::dvec3 lab = labOfSrgb(rgb);
    // An angle's cosine c is known to half a unit of 1; the angle then to that over its sine, here above 0.1.
    EXPECT_LT(glm::distance(hb::mshToLab(hb::labToMsh(lab)), lab), glm::length(lab) * 40 * 0x1p-53);
  }
  EXPECT_EQ(hb::labToMsh(glm::dvec3(0)), glm::dvec3(0));
  EXPECT_EQ(hb::labToMsh({50, 0, 0}), glm::dvec3(50, 0, 0));
}

TEST(hbColorSpace, MshMixesOverWhiteOrTheShortWayRound) {
  const glm::dvec3 red{80, 1, 0.5}, blue{60, 1.2, -1.5};
  EXPECT_EQ(hb::mixMsh(red, blue, 0.0), red);
  EXPECT_EQ(hb::mixMsh(red, blue, 1.0), blue);
  EXPECT_EQ(hb::mixMsh(red, blue, 0.5).x, 88.0);
  EXPECT_EQ(hb::mixMsh(red, blue, 0.5).y, 0.0);
  // Hues on the two sides of pi, 0.2 apart: the middle lies at pi, either way round, and no white comes between.
  for (const double sign : {1.0, -1.0}) {
    const glm::dvec3 middle = hb::mixMsh({70, 1, sign * 3.0}, {70, 1, -sign * (6.283185307179586 - 3.2)}, 0.5);
    EXPECT_NEAR(middle.y, 1.0, 4 * 0x1p-53);
    EXPECT_NEAR(middle.z, sign * 3.1, 32 * 0x1p-53);
  }
  // A gray end takes a hue from the other one, up to the adjustment where that one is darker.
  EXPECT_EQ(hb::mixMsh({40, 0, 0}, {80, 1, 0.5}, 0.25).z, 0.5);
}
