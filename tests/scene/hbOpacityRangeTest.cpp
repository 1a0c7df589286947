#include "scene/hbOpacityRange.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

using OpacityPoint = hbTransferFunction::OpacityPoint;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

hbTransferFunction function(std::vector<OpacityPoint> points, bool zero = false) {
  return hbTransferFunction({.colors = {{-2000, glm::dvec3(0)}, {2000, glm::dvec3(1)}},
                             .opacities = std::move(points),
                             .outside = zero ? hbTransferFunction::Outside::zero : hbTransferFunction::Outside::clamp});
}

/// What maximum() promises, by looking everywhere: at the ends, at both sides of every point inside, and at many values
/// between, none of which can exceed it.
double search(const hbTransferFunction& f, double lo, double hi) {
  double greatest = std::max(f.opacity(lo), f.opacity(hi));
  const auto see = [&](double value) { greatest = std::max(greatest, f.opacity(value)); };
  const auto& points = f.definition().opacities;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double value = points[i].value;
    if (value < lo || value > hi) continue;
    see(value);
    // The side below a step: the first of its points, or what lies beyond the first of all.
    if (i == 0) see(std::nextafter(value, -kInfinity));
    if (i == 0 || points[i - 1].value < value) greatest = std::max(greatest, points[i].opacity);
    if (i + 1 == points.size()) see(std::nextafter(value, kInfinity));
  }
  for (int i = 1; i < 500; ++i) see(lo + (hi - lo) * i / 500.0);
  return greatest;
}

} // namespace

RC_GTEST_PROP(hbOpacityRange, IsTheGreatestOpacity, ()) {
  const int n = *rc::gen::inRange(1, 40);
  // A few values in a small part of the range: steps of several points, and crowded cells of the grid.
  const int spread = *rc::gen::element(3, 30, 1000);
  const bool linear = *rc::gen::arbitrary<bool>();
  std::vector<OpacityPoint> points;
  for (int i = 0; i < n; ++i) {
    const double fractions[3] = {*rc::gen::inRange(0, 101) / 100.0, *rc::gen::inRange(0, 101) / 100.0,
                                 *rc::gen::inRange(0, 101) / 100.0};
    points.push_back({double(*rc::gen::inRange(-spread, spread)), fractions[0], linear ? 0.5 : fractions[1],
                      linear ? 0.0 : fractions[2]});
  }
  if (*rc::gen::arbitrary<bool>()) points.push_back({1000.0, 0.5});
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  const hbTransferFunction f = function(points, *rc::gen::arbitrary<bool>());
  const hbOpacityRange range(f);
  for (int i = 0; i < 20; ++i) {
    const double a = *rc::gen::inRange(-4 * spread - 8, 4 * spread + 8) / 4.0;
    const double b = *rc::gen::element(a, a + 0.25, a + 3.0, a + double(spread), 1500.0);
    const double lo = std::min(a, b), hi = std::max(a, b);
    // Linear pieces are monotone in their rounded values too; curved ones to a few roundings of numbers up to 1.
    RC_ASSERT(std::abs(range.maximum(lo, hi) - search(f, lo, hi)) <= (linear ? 0.0 : 8 * 0x1p-53));
  }
}

TEST(hbOpacityRange, AStepHasBothItsSides) {
  const hbOpacityRange range(function({{0, 0.1}, {1, 0.1}, {1, 1.0}, {1, 0.7}, {2, 0.2}}));
  EXPECT_EQ(range.maximum(0.0, 0.5), 0.1);
  EXPECT_EQ(range.maximum(0.0, 1.0), 0.7); // the point in the middle of the step is never seen
  EXPECT_EQ(range.maximum(1.0, 1.0), 0.7);
  EXPECT_EQ(range.maximum(2.0, 3.0), 0.2);
  const hbOpacityRange down(function({{0, 0.9}, {1, 0.9}, {1, 0.0}, {2, 0.0}}));
  EXPECT_EQ(down.maximum(1.0, 2.0), 0.9);
  EXPECT_EQ(down.maximum(std::nextafter(1.0, 2.0), 2.0), 0.0);
}

TEST(hbOpacityRange, IntervalsWithoutEndsOrValues) {
  const std::vector<OpacityPoint> points{{0, 0.3}, {1, 0.1}, {2, 0.8}};
  const hbOpacityRange clamped(function(points)), zero(function(points, true));
  EXPECT_EQ(clamped.maximum(-kInfinity, -1.0), 0.3);
  EXPECT_EQ(clamped.maximum(3.0, kInfinity), 0.8);
  EXPECT_EQ(zero.maximum(-kInfinity, -1.0), 0.0);
  EXPECT_EQ(zero.maximum(3.0, kInfinity), 0.0);
  EXPECT_EQ(zero.maximum(-kInfinity, kInfinity), 0.8);
  EXPECT_EQ(zero.maximum(kNaN, 0.5), 0.3);
  EXPECT_EQ(zero.maximum(0.5, kNaN), 0.8);
  EXPECT_EQ(zero.maximum(kNaN, kNaN), 0.8);
  EXPECT_EQ(zero.maximum(1.0, 0.0), 0.0);
  const hbOpacityRange one(function({{5, 0.4}}, true));
  EXPECT_EQ(one.maximum(5.0, 5.0), 0.4);
  EXPECT_EQ(one.maximum(4.0, 6.0), 0.4);
  EXPECT_EQ(one.maximum(5.5, 6.0), 0.0);
}

TEST(hbOpacityRange, PointsFarApartAndClose) {
  const double most = std::numeric_limits<float>::max(), least = std::numeric_limits<double>::denorm_min();
  const hbOpacityRange far(function({{-most, 0.1}, {0, 0.9}, {least, 0.2}, {most, 0.3}}));
  EXPECT_EQ(far.maximum(-most, -most), 0.1);
  EXPECT_EQ(far.maximum(-1.0, 1.0), 0.9);
  EXPECT_EQ(far.maximum(least, 1.0), 0.2);
  EXPECT_EQ(far.maximum(1.0, most), 0.3);
  const hbOpacityRange close(function({{0, 0.9}, {least, 0.2}}));
  EXPECT_EQ(close.maximum(0.0, 0.0), 0.9);
  EXPECT_EQ(close.maximum(least, 1.0), 0.2);
}

TEST(hbOpacityRange, AnotherFunctionNeedsAnotherRange) {
  const hbTransferFunction f = function({{0, 0.0}, {1, 1.0}});
  const hbOpacityRange before(f), after(f.rescaled(-4000, 0));
  EXPECT_EQ(before.maximum(-1.0, 0.0), 0.0);
  EXPECT_GT(after.maximum(-1.0, 0.0), 0.0);
}
