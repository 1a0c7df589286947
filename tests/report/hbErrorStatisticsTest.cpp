#include "report/hbErrorStatistics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

hbErrorStatistics of(std::initializer_list<std::pair<double, double>> pairs) {
  hbErrorStatistics statistics;
  for (const auto& [reference, value] : pairs) statistics.add(reference, value);
  return statistics;
}
} // namespace

TEST(hbErrorStatistics, AddsUpByHand) {
  const auto s = of({{0, 3}, {10, 6}, {5, 5}, {-10, -10}}); // errors 3, 4, 0, 0
  EXPECT_EQ(s.count, 4);
  EXPECT_EQ(s.max, 4.0);
  EXPECT_EQ(s.rmse(), 2.5);
  EXPECT_EQ(s.lo, -10.0);
  EXPECT_EQ(s.hi, 10.0);
  EXPECT_DOUBLE_EQ(*s.psnr(), 20 * std::log10(20.0 / 2.5));
  EXPECT_DOUBLE_EQ(*s.psnr(2.5), 0.0);
}

TEST(hbErrorStatistics, EqualsHaveNoPsnrAndNeitherHasAReferenceWithoutRange) {
  EXPECT_FALSE(of({{1, 1}, {2, 2}}).psnr());
  EXPECT_FALSE(of({{1, 1}}).psnr(255.0));
  EXPECT_FALSE(of({{5, 6}, {5, 7}}).psnr());
  EXPECT_FALSE(hbErrorStatistics{}.psnr());
  EXPECT_EQ(hbErrorStatistics{}.rmse(), 0.0);
}

TEST(hbErrorStatistics, NaNAndInfinity) {
  EXPECT_EQ(of({{kNaN, kNaN}, {kInf, kInf}, {-kInf, -kInf}}).max, 0.0);
  EXPECT_EQ(of({{kNaN, 1}}).max, kInf);
  EXPECT_EQ(of({{1, kNaN}}).max, kInf);
  EXPECT_EQ(of({{kInf, -kInf}}).max, kInf);
  const auto s = of({{0, kNaN}, {1, 1}, {kInf, kInf}});
  EXPECT_EQ(s.rmse(), kInf);
  EXPECT_EQ(s.hi, 1.0); // infinities are no part of the range
  EXPECT_EQ(*s.psnr(), -kInf);
}

TEST(hbErrorStatistics, MergingIsAddingTheParts) {
  auto a = of({{0, 3}, {10, 6}});
  a.merge(of({{5, 5}, {-10, -8}}));
  const auto b = of({{0, 3}, {10, 6}, {5, 5}, {-10, -8}}); // small integers: the sums are exact
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.max, b.max);
  EXPECT_EQ(a.sumSquares, b.sumSquares);
  EXPECT_EQ(a.lo, b.lo);
  EXPECT_EQ(a.hi, b.hi);
}
