#include "scene/hbShading.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbError.h"

namespace {

const glm::dvec3 kAway(0.0, 0.0, -1.0), kNowhere(0.0);

/// A unit vector this many degrees off the viewer, who looks along -z.
glm::dvec3 tilted(double degrees) {
  const double angle = degrees * std::acos(-1.0) / 180.0;
  return {std::sin(angle), 0.0, std::cos(angle)};
}

hbShading only(double ambient, double diffuse, double specular, double shininess) {
  hbShading s;
  s.ambient = ambient;
  s.diffuse = diffuse;
  s.specular = specular;
  s.shininess = shininess;
  return s;
}

} // namespace

TEST(hbShading, AHeadLightFallsOffWithTheCosine) {
  const hbShading s = only(0.1, 0.5, 0.25, 3.0);
  for (const double degrees : {0.0, 30.0, 60.0, 89.0, 120.0, 180.0}) {
    const double cosine = std::abs(tilted(degrees).z); // both sides are alike
    const auto r = s.reflection(kNowhere, kAway, 7.0 * tilted(degrees));
    EXPECT_NEAR(r.matter.r, 0.1 + 0.5 * cosine, 1e-15) << degrees;
    EXPECT_NEAR(r.gloss.g, 0.25 * std::pow(cosine, 3.0), 1e-15) << degrees;
  }
}

TEST(hbShading, GlossIsAPowerWhateverItsExponent) {
  for (const double exponent : {0.0, 1.0, 2.5, 24.0, 31.0, 1000.0, 10000.0})
    for (const double degrees : {0.0, 3.0, 70.0}) {
      const double cosine = tilted(degrees).z, expected = std::pow(cosine, exponent);
      const double found = only(0.0, 0.0, 1.0, exponent).reflection(kNowhere, kAway, tilted(degrees)).gloss.r;
      // The normal is made of length 1 again: some ulps of the cosine, and each product's.
      EXPECT_NEAR(found, expected, expected * (exponent + 16.0) * 0x1p-50) << exponent << " " << degrees;
    }
}

TEST(hbShading, PlacedLightsShineFromWhereTheyAre) {
  hbShading s = only(0.0, 1.0, 1.0, 2.0);
  s.lights = {{{10.0, 0.0, 0.0}, {1.0, 0.5, 0.0}}, {{0.0, 0.0, -5.0}, {9.0, 9.0, 9.0}}}; // the second from behind
  const auto r = s.reflection({2.0, 0.0, 0.0}, kAway, tilted(30.0));
  const double diffuse = 0.5, half = std::cos(std::acos(-1.0) / 12.0); // 45 - 30 degrees off the halfway vector
  EXPECT_NEAR(r.matter.r, diffuse, 1e-15);
  EXPECT_NEAR(r.matter.g, 0.5 * diffuse, 1e-15);
  EXPECT_EQ(r.matter.b, 0.0);
  EXPECT_NEAR(r.gloss.r, half * half, 1e-15);
  EXPECT_NEAR(r.gloss.g, 0.5 * half * half, 1e-15);
}

TEST(hbShading, WithoutAGradientThereIsNoSurface) {
  const auto r = only(0.25, 0.5, 1.0, 8.0).reflection(kNowhere, kAway, kNowhere);
  EXPECT_EQ(r.matter, glm::dvec3(0.75));
  EXPECT_EQ(r.gloss, kNowhere);
}

RC_GTEST_PROP(hbShading, TheLengthOfAGradientDoesNotMatter, ()) {
  const int exponent = *rc::gen::inRange(-300, 300);
  const glm::dvec3 gradient(*rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10), 1.0);
  const hbShading s;
  const auto one = s.reflection(kNowhere, kAway, gradient),
             other = s.reflection(kNowhere, kAway, std::pow(10.0, exponent) * gradient);
  RC_ASSERT(glm::length(one.matter - other.matter) < 1e-13);
  RC_ASSERT(glm::length(one.gloss - other.gloss) < 1e-12);
}

TEST(hbShading, RefusesWhatIsOutOfRange) {
  const auto refuses = [](auto change) {
    hbShading s;
    s.lights.resize(1);
    change(s);
    EXPECT_THROW(s.validate("shading"), hbError);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  refuses([](hbShading& s) { s.ambient = -0.1; });
  refuses([](hbShading& s) { s.diffuse = kNaN; });
  refuses([](hbShading& s) { s.specular = 1001.0; });
  refuses([](hbShading& s) { s.shininess = -1.0; });
  refuses([](hbShading& s) { s.lights.resize(9); });
  refuses([](hbShading& s) { s.lights[0].position.y = kNaN; });
  refuses([](hbShading& s) { s.lights[0].colour.b = -1.0; });
  EXPECT_NO_THROW(hbShading{}.validate("shading"));
}
