#include "scene/hbColormap.h"

#include <algorithm>
#include <limits>
#include <string>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "scene/hbColorSpace.h"
#include "volume/hbError.h"

namespace {
double luminance(const glm::dvec3& coded) { return hb::linearToXyz(hb::srgbToLinear(coded)).y; }
} // namespace

TEST(hbColormap, EndsAreThePublishedOnes) {
  EXPECT_EQ(hbColormap("gray").rgb(0), glm::dvec3(0));
  EXPECT_EQ(hbColormap("gray").rgb(0.25), glm::dvec3(0.25));
  EXPECT_EQ(hbColormap("gray").rgb(1), glm::dvec3(1));
  EXPECT_EQ(hbColormap("inverse-gray").rgb(0), glm::dvec3(1));
  EXPECT_EQ(hbColormap("inverse-gray").rgb(1), glm::dvec3(0));
  EXPECT_EQ(hbColormap("heat").rgb(0), glm::dvec3(0));
  EXPECT_EQ(hbColormap("heat").rgb(0.5), glm::dvec3(1, 0.5, 0));
  EXPECT_EQ(hbColormap("heat").rgb(1), glm::dvec3(1));
  EXPECT_EQ(hbColormap("cubehelix").rgb(0), glm::dvec3(0));
  EXPECT_EQ(hbColormap("cubehelix").rgb(1), glm::dvec3(1));
}

TEST(hbColormap, CoolwarmHasMorelandsColours) {
  // The published table is rounded to bytes (half a unit); its matrix and white may have other digits (half a unit).
  const hbColormap map("coolwarm");
  const auto near = [&](double t, const glm::dvec3& bytes) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(255.0 * map.rgb(t)[c], bytes[c], 1.0) << "t = " << t << ", channel " << c;
  };
  near(0.0, {59, 76, 192});
  near(0.25, {141, 176, 254});
  near(0.5, {221, 221, 221});
  near(0.75, {244, 154, 123});
  near(1.0, {180, 4, 38});
}

TEST(hbColormap, LuminanceNeverFalls) {
  for (const char* name : {"gray", "heat"}) {
    const hbColormap map(name);
    for (int i = 1; i <= 1000; ++i)
      EXPECT_GE(luminance(map.rgb(i / 1000.0)), luminance(map.rgb((i - 1) / 1000.0))) << name << " " << i;
  }
}

TEST(hbColormap, CubehelixGrowsInGreensBrightness) {
  // Green's brightness 0.30 R + 0.59 G + 0.11 B is t where no channel is clipped, up to his constants' five digits
  // (below 1e-5); clipping moves it, but never makes it fall by more than a step of the map.
  const hbColormap map("cubehelix");
  const auto brightness = [&](double t) { return glm::dot(map.rgb(t), glm::dvec3(0.30, 0.59, 0.11)); };
  for (int i = 0; i <= 1000; ++i) {
    const glm::dvec3 c = map.rgb(i / 1000.0);
    const bool clipped = std::min({c.x, c.y, c.z}) <= 0.0 || std::max({c.x, c.y, c.z}) >= 1.0;
    if (!clipped) {
      EXPECT_NEAR(brightness(i / 1000.0), i / 1000.0, 1e-5) << i;
    }
    if (i > 0) {
      EXPECT_GT(brightness(i / 1000.0), brightness((i - 1) / 1000.0)) << i;
    }
  }
}

TEST(hbColormap, AllMapsAreContinuousAndInRange) {
  for (const std::string_view name : hbColormap::names()) {
    const hbColormap map(name);
    EXPECT_EQ(map.name(), name);
    for (int i = 0; i <= 1000; ++i) {
      const glm::dvec3 c = map.rgb(i / 1000.0);
      for (int d = 0; d < 3; ++d) {
        EXPECT_GE(c[d], 0.0);
        EXPECT_LE(c[d], 1.0);
      }
      // No map is steeper than 8 (cubehelix: 1 + 1.97 (1/2 + 3 pi / 8) < 5 a channel) in length per unit of t.
      if (i > 0) {
        EXPECT_LT(glm::distance(c, map.rgb((i - 1) / 1000.0)), 8e-3) << name << " " << i;
      }
    }
  }
}

TEST(hbColormap, ClampsAndTakesNaNAsZero) {
  const hbColormap map("gray");
  EXPECT_EQ(map.rgb(-1.0), glm::dvec3(0));
  EXPECT_EQ(map.rgb(7.0), glm::dvec3(1));
  EXPECT_EQ(map.rgb(std::numeric_limits<double>::quiet_NaN()), glm::dvec3(0));
}

TEST(hbColormap, RefusesUnknownNamesAndListsTheKnown) {
  try {
    const hbColormap map("jet");
    FAIL();
  } catch (const hbError& e) {
    EXPECT_STREQ(e.what(), "colormap: expected one of gray, inverse-gray, heat, cubehelix, coolwarm, found 'jet'");
  }
}
