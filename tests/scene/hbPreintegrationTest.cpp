#include "scene/hbPreintegration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "volume/hbError.h"

namespace {

constexpr double kFloatEps = 0x1p-24;

/// The definition, by many equal steps of the midpoint rule, each with its own attenuation.
glm::dvec4 quadrature(const hbTransferFunction& f, double front, double back, double thickness, int steps) {
  glm::dvec3 colour(0.0);
  double transmittance = 1.0;
  for (int i = 0; i < steps; ++i) {
    const double value = front + (back - front) * (i + 0.5) / steps;
    const double through = std::exp(-f.extinction(value) * thickness / steps);
    colour += transmittance * (1.0 - through) * f.colour(value);
    transmittance *= through;
  }
  return {colour, 1.0 - transmittance};
}

/// Straight in linear light is not straight in coded values; between these the colour has a slope of 2.4 at most.
hbTransferFunction smooth() {
  return hbTransferFunction(
      {.colors = {{0, {0.9, 0.2, 0.1}}, {4, {0.1, 0.3, 1.0}}}, .opacities = {{0, 0.1}, {4, 0.5}}, .unitLength = 0.5});
}

} // namespace

TEST(hbPreintegration, ConstantFunctionsHaveAClosedForm) {
  const hbTransferFunction f(
      {.colors = {{0, {1, 0.5, 0}}, {1, {1, 0.5, 0}}}, .opacities = {{0, 0.3}, {1, 0.3}}, .unitLength = 2.0});
  const hbPreintegration table(f, 0.0, 1.0, 3.0, 33);
  const double opacity = 1.0 - std::pow(0.7, 1.5);
  for (const glm::vec4& entry : table.entries()) {
    // 32 pieces are composited: a rounding each far below that of the entry to 32 bits.
    EXPECT_NEAR(entry.w, opacity, kFloatEps);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(entry[c], opacity * f.colour(0.5)[c], kFloatEps);
  }
}

TEST(hbPreintegration, EntriesAreTheVolumeIntegral) {
  const hbTransferFunction f = smooth();
  constexpr std::size_t kEntries = 17;
  constexpr double kThickness = 1.5, kStep = 4.0 / (kEntries - 1);
  const hbPreintegration table(f, 0.0, 4.0, kThickness, kEntries);
  // Extinction -2 ln(0.9 - 0.1 v): slope at most 0.4, second derivative at most 2 (0.1 / 0.5)^2 = 0.08. The means of 8
  // samples and the steps of the quadrature (which are finer) are midpoint rules: h^2 f'' / 24.
  const double sample = kStep / hbPreintegration::kSamplesPerCell;
  const double opacityError = kThickness * 0.08 * sample * sample / 24;
  // Colours change by 0.2 in coded values a unit, by 0.5 after decoding (slope below 2.4); a cell is at most opaque
  // 1 - 0.5^3 (where both values are equal it is exact).
  const double colourError = 0.5 * kStep * (1.0 - 0.125) + opacityError;
  for (std::size_t i = 0; i < kEntries; ++i) {
    for (std::size_t j = 0; j < kEntries; ++j) {
      const glm::dvec4 expected = quadrature(f, kStep * double(i), kStep * double(j), kThickness, 4000);
      const glm::dvec4 found(table.entries()[i * kEntries + j]);
      EXPECT_NEAR(found.w, expected.w, 2 * opacityError + kFloatEps) << i << " " << j;
      // The bound of the colour falls with the opacity of one cell, which is that of a slab k times thinner.
      const double k = std::max(1.0, std::abs(double(i) - double(j)));
      const double cellOpacity = 1.0 - std::pow(0.5, 3.0 / k);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], colourError * cellOpacity / 0.875 + 3 * opacityError + kFloatEps)
            << i << " " << j << " " << c;
    }
  }
}

TEST(hbPreintegration, FinerTablesConvergeToTheVolumeIntegral) {
  // Colour and opacity in one piece of one sign: the error of a table's cells falls at least linearly with their width.
  const hbTransferFunction f = smooth();
  double before = 1.0;
  for (const std::size_t entries : {9U, 33U, 129U}) {
    const hbPreintegration table(f, 0.0, 4.0, 1.5, entries);
    double greatest = 0.0;
    for (const auto& [front, back] : {std::pair(0.5F, 3.5F), std::pair(3.5F, 0.5F), std::pair(4.0F, 0.0F)}) {
      const glm::dvec4 expected = quadrature(f, front, back, 1.5, 20000), found(table.at(front, back));
      for (int c = 0; c < 4; ++c) greatest = std::max(greatest, std::abs(found[c] - expected[c]));
    }
    EXPECT_LT(greatest, before / 4) << entries;
    before = greatest;
  }
}

TEST(hbPreintegration, APeakBetweenTwoSamplesIsSeen) {
  // Width 0.25 of 1 and opacity 0.5: neither end sees it, half of a quarter of the slab does.
  const hbTransferFunction f({.colors = {{0, glm::dvec3(1)}, {1, glm::dvec3(1)}},
                              .opacities = {{0.5, 0.5}, {0.75, 0.5}},
                              .outside = hbTransferFunction::Outside::zero,
                              .unitLength = 1.0});
  const hbPreintegration table(f, 0.0, 1.0, 1.0, 65);
  // The peak covers 16 whole cells.
  EXPECT_NEAR(table.at(0.0F, 1.0F).w, 1.0 - std::pow(0.5, 0.25), kFloatEps);
  EXPECT_NEAR(table.at(1.0F, 0.0F).w, 1.0 - std::pow(0.5, 0.25), kFloatEps);
  EXPECT_EQ(table.at(0.0F, 0.25F).w, 0.0F);
  EXPECT_NEAR(table.at(0.625F, 0.625F).w, 0.5, kFloatEps);
}

TEST(hbPreintegration, FrontAndBackAreNotTheSame) {
  // Opaque red in front of opaque blue is red. The middle is no value of an entry.
  const hbTransferFunction f({.colors = {{0, {1, 0, 0}}, {0.5, {1, 0, 0}}, {0.5, {0, 0, 1}}, {1, {0, 0, 1}}},
                              .opacities = {{0, 1.0}, {1, 1.0}},
                              .unitLength = 1.0});
  const hbPreintegration table(f, 0.0, 1.0, 10.0, 65);
  EXPECT_EQ(table.at(0.0F, 1.0F), glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(table.at(1.0F, 0.0F), glm::vec4(0, 0, 1, 1));
}

TEST(hbPreintegration, ValuesOutsideAndNaN) {
  const hbPreintegration table(smooth(), 0.0, 4.0, 1.0, 5);
  EXPECT_EQ(table.at(-7.0F, 9.0F), table.at(0.0F, 4.0F));
  EXPECT_EQ(table.at(std::numeric_limits<float>::quiet_NaN(), 1.0F), glm::vec4(0.0F));
  EXPECT_EQ(table.at(1.0F, std::numeric_limits<float>::quiet_NaN()), glm::vec4(0.0F));
  EXPECT_EQ(table.at(-std::numeric_limits<float>::infinity(), 4.0F), table.at(0.0F, 4.0F));
}

TEST(hbPreintegration, RefusesWhatItCannotHold) {
  const hbTransferFunction f = smooth();
  EXPECT_THROW(hbPreintegration(f, 0.0, 1.0, 1.0, 1), hbError);
  EXPECT_THROW(hbPreintegration(f, 0.0, 1.0, 1.0, hbPreintegration::kMaxEntries + 1), hbError);
  EXPECT_THROW(hbPreintegration(f, 1.0, 1.0, 1.0), hbError);
  EXPECT_THROW(hbPreintegration(f, 0.0, std::numeric_limits<double>::infinity(), 1.0), hbError);
  EXPECT_THROW(hbPreintegration(f, 0.0, 1.0, 0.0), hbError);
  EXPECT_THROW(hbPreintegration(hbTransferFunction::preset("fire"), 0.0, 1.0, 1.0), hbError);
}

TEST(hbPreintegration, ClearSlabsHaveNoOpacity) {
  const hbTransferFunction f({.colors = {{0, {1, 1, 1}}, {10, {1, 1, 1}}},
                              .opacities = {{0, 0.0}, {3, 0.0}, {5, 0.6}, {7, 0.0}, {10, 0.0}},
                              .unitLength = 1.0});
  const hbPreintegration table(f, -1.0, 11.0, 0.5, 97);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (float front = -2.0F; front < 12.0F; front += 0.0625F)
    for (float back = -2.0F; back < 12.0F; back += 0.0625F)
      if (table.isClear(front, back)) {
        EXPECT_EQ(table.at(front, back).a, 0.0F) << front << " " << back;
      }
  EXPECT_TRUE(table.isClear(-2.0F, 2.5F));
  EXPECT_TRUE(table.isClear(12.0F, 7.5F));
  EXPECT_FALSE(table.isClear(2.0F, 8.0F)); // past what is seen
  EXPECT_FALSE(table.isClear(2.0F, nan));
  EXPECT_FALSE(table.isClear(nan, nan));
}

TEST(hbPreintegration, NothingIsClearOfWhatIsSeenEverywhere) {
  const hbPreintegration table(smooth(), 0.0, 4.0, 0.5, 33);
  for (const float value : {-1.0F, 0.0F, 2.0F, 4.0F, 5.0F}) EXPECT_FALSE(table.isClear(value, value));
}
