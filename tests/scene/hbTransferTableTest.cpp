#include "scene/hbTransferTable.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "volume/hbError.h"

namespace {

constexpr double kFloatEps = 0x1p-24;

glm::dvec4 reference(const hbTransferFunction& f, double value) { return {f.colour(value), f.extinction(value)}; }

} // namespace

TEST(hbTransferTable, EntriesAreTheFunction) {
  const hbTransferFunction f = hbTransferFunction::preset("ct-bone");
  const hbTransferTable table(f, 96); // 95 spacings of 30 units: every entry's value is exact
  ASSERT_EQ(table.entries().size(), 96U);
  for (int i = 0; i < 96; ++i) {
    const double value = 150 + 30 * i;
    const glm::dvec4 expected = reference(f, value);
    // One rounding to 32 bits, and the place in the table to 64 bits.
    for (int c = 0; c < 4; ++c)
      EXPECT_NEAR(table.at(float(value))[c], expected[c], 1.01 * kFloatEps * std::max(1.0, expected[c])) << i;
  }
}

TEST(hbTransferTable, LiesBetweenTheFunctionsEnds) {
  for (const std::string_view name : hbTransferFunction::presetNames()) {
    const hbTransferFunction f = hbTransferFunction::preset(name).withUnitLength(0.5);
    const hbTransferTable table(f);
    const auto [lo, hi] = f.range();
    const double h = (hi - lo) / double(hbTransferTable::kDefaultEntries - 1);
    for (int i = 0; i <= 10000; ++i) {
      const float value = float(lo + (hi - lo) * i / 10000.0);
      if (value < lo || value > hi) continue;
      const double cell = std::min(std::floor((value - lo) / h), double(hbTransferTable::kDefaultEntries - 2));
      const glm::dvec4 a = reference(f, lo + cell * h), b = reference(f, std::min(lo + (cell + 1) * h, hi));
      for (int c = 0; c < 4; ++c) {
        // The entries' rounding, three roundings of the interpolation, and entries' values a rounding of 64 bits apart.
        const double room = 8 * kFloatEps * std::max({1.0, a[c], b[c]});
        EXPECT_GE(table.at(value)[c], std::min(a[c], b[c]) - room) << name << " " << value << " " << c;
        EXPECT_LE(table.at(value)[c], std::max(a[c], b[c]) + room) << name << " " << value << " " << c;
      }
    }
  }
}

TEST(hbTransferTable, ErrorFallsWithTheSquareOfTheSpacing) {
  // One piece: coded channels t and 1 - t; decoding has the second derivative 2.4 1.4 / 1.055^2 < 3.02 at most. The
  // extinction -ln(1 - t / 2) / 1 has 1 / (2 - t)^2 <= 1.
  const hbTransferFunction f(
      {.colors = {{0, {0.05, 1, 0.5}}, {1, {1, 0.05, 0.5}}}, .opacities = {{0, 0.0}, {1, 0.5}}, .unitLength = 1.0});
  for (const std::size_t entries : {17U, 257U}) {
    const hbTransferTable table(f, entries);
    const double h = 1.0 / double(entries - 1), bound = 3.02 * h * h / 8;
    double greatest = 0.0;
    for (int i = 0; i <= 5000; ++i) {
      const float value = float(i / 5000.0);
      const glm::dvec4 expected = reference(f, value), found(table.at(value));
      for (int c = 0; c < 4; ++c) {
        const double error = std::abs(found[c] - expected[c]);
        EXPECT_LE(error, (c < 3 ? bound : h * h / 8) + 4 * kFloatEps) << entries << " " << value << " " << c;
        greatest = std::max(greatest, error);
      }
    }
    EXPECT_GT(greatest, 0.5 * bound); // the bound is not idle
  }
}

TEST(hbTransferTable, ValuesOutsideTheRangeAndNaNAreExact) {
  const hbTransferFunction f({.colors = {{0, glm::dvec3(0)}, {1, glm::dvec3(1)}},
                              .opacities = {{0, 0.5}, {1, 0.5}},
                              .belowColor = glm::dvec3(0, 0, 1),
                              .aboveColor = glm::dvec3(1, 0, 0),
                              .nanColor = {0, 1, 0},
                              .nanOpacity = 0.25,
                              .outside = hbTransferFunction::Outside::zero,
                              .unitLength = 2.0});
  const hbTransferTable table(f, 2);
  EXPECT_EQ(table.range(), std::pair(0.0, 1.0));
  EXPECT_EQ(table.at(-0.001F), glm::vec4(0, 0, 1, 0));
  EXPECT_EQ(table.at(1.001F), glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(table.at(std::numeric_limits<float>::infinity()), glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(table.at(std::numeric_limits<float>::quiet_NaN()), glm::vec4(0, 1, 0, float(-std::log(0.75) / 2.0)));
  EXPECT_EQ(table.at(1.0F), glm::vec4(1, 1, 1, float(std::log(2.0) / 2.0)));
}

TEST(hbTransferTable, ExtremeRanges) {
  for (const double hi :
       {double(std::numeric_limits<float>::denorm_min()), double(std::numeric_limits<float>::max())}) {
    const hbTransferFunction f = hbTransferFunction::preset("fire").withUnitLength(1.0).rescaled(0.0, hi);
    const hbTransferTable table(f, hbTransferTable::kMaxEntries);
    EXPECT_EQ(table.at(0.0F), glm::vec4(reference(f, 0.0)));
    EXPECT_EQ(table.at(float(hi)), glm::vec4(reference(f, hi)));
  }
}

TEST(hbTransferTable, RefusesWhatItCannotHold) {
  const hbTransferFunction f = hbTransferFunction::preset("fire");
  EXPECT_THROW(hbTransferTable{f}, hbError); // no unit length
  for (const std::size_t entries : {std::size_t{0}, std::size_t{1}, hbTransferTable::kMaxEntries + 1})
    EXPECT_THROW(hbTransferTable(f.withUnitLength(1.0), entries), hbError);
}

TEST(hbTransferTable, ClearValuesHaveNoExtinction) {
  using Points = std::vector<hbTransferFunction::OpacityPoint>;
  const auto infinity = std::numeric_limits<float>::infinity();
  for (const Points& points :
       {Points{{0.0, 0.0}, {0.3, 0.0}, {0.5, 0.6}, {0.7, 0.0}, {1.0, 0.0}}, Points{{0.0, 0.2}, {0.4, 0.0}, {1.0, 0.0}},
        Points{{0.0, 0.0}, {1.0, 0.0}}, Points{{0.0, 0.0}, {1.0, 1e-9}}, Points{{0.0, 0.1}, {1.0, 0.1}}})
    for (const auto outside : {hbTransferFunction::Outside::clamp, hbTransferFunction::Outside::zero})
      for (const std::size_t entries : {2U, 3U, 97U}) {
        const hbTransferTable table(hbTransferFunction({.colors = {{0.0, {1, 1, 1}}, {1.0, {1, 1, 1}}},
                                                        .opacities = points,
                                                        .nanOpacity = 0.5,
                                                        .outside = outside,
                                                        .unitLength = 1.0}),
                                    entries);
        std::vector<float> values{-infinity, -1.0F, -0.001F, 1.001F, 2.0F, infinity};
        for (std::size_t i = 0; i < entries; ++i)
          for (const float around : {-1e-3F, -6e-8F, 0.0F, 6e-8F, 1e-3F})
            values.push_back(float(double(i) / double(entries - 1)) + around);
        for (const float value : values)
          if (table.isClear(value)) {
            EXPECT_EQ(table.at(value).a, 0.0F) << value;
          }
        EXPECT_FALSE(table.isClear(std::numeric_limits<float>::quiet_NaN()));
      }
}

TEST(hbTransferTable, WhatIsFarFromAllExtinctionIsClear) {
  const hbTransferTable table(hbTransferFunction({.colors = {{0.0, {1, 1, 1}}, {1.0, {1, 1, 1}}},
                                                  .opacities = {{0.0, 0.0}, {0.4, 0.0}, {0.5, 0.6}, {0.7, 0.0}},
                                                  .unitLength = 1.0}));
  // Two cells of 4096 around what is seen are not promised.
  for (const float value : {-1.0F, 0.0F, 0.39F, 0.71F, 1.0F, 9.0F}) EXPECT_TRUE(table.isClear(value)) << value;
  for (const float value : {0.41F, 0.5F, 0.69F}) EXPECT_FALSE(table.isClear(value)) << value;
}
