#include "report/hbLogAxis.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

std::vector<std::string> labels(const std::vector<double>& values) {
  std::vector<std::string> result;
  for (const auto& tick : hbLogAxis::of(values).ticks) result.push_back(tick.label);
  return result;
}

TEST(hbLogAxis, shortRangesHaveTicksWithinTheDecades) {
  EXPECT_EQ(labels({0.002, 0.05}), (std::vector<std::string>{"0.002", "0.005", "0.01", "0.02", "0.05"}));
  EXPECT_EQ(labels({3.0, 60.0}), (std::vector<std::string>{"5", "10", "20", "50"}));
}

TEST(hbLogAxis, longRangesHavePowersOfTen) {
  EXPECT_EQ(labels({2e-6, 30.0}), (std::vector<std::string>{"1e-5", "1e-4", "0.001", "0.01", "0.1", "1", "10"}));
  EXPECT_LE(labels({1e-300, 1e300}).size(), 9U);
}

TEST(hbLogAxis, oneValueHasADecadeAroundIt) {
  const auto axis = hbLogAxis::of(std::vector{7.0});
  EXPECT_NEAR(axis.hi / axis.lo, 10.0, 1e-12); // a few roundings
  EXPECT_GE(axis.ticks.size(), 2U);
}

TEST(hbLogAxis, zerosLieBelowThePositiveValues) {
  const auto axis = hbLogAxis::of(std::vector{0.0, 3.0, 60.0});
  ASSERT_TRUE(axis.zero);
  EXPECT_GT(*axis.zero, axis.lo);
  EXPECT_LT(*axis.zero, 3.0);
  EXPECT_EQ(axis.ticks.front().label, "0");
  EXPECT_EQ(axis.ticks.front().value, *axis.zero);
  EXPECT_EQ(axis.place(0.0), *axis.zero);
  EXPECT_EQ(axis.place(3.0), 3.0);
  EXPECT_FALSE(hbLogAxis::of(std::vector{3.0, 60.0}).zero);
}

TEST(hbLogAxis, nothingButZerosAndNothingAtAllAreShown) {
  for (const std::vector<double>& values : {std::vector<double>{0.0, 0.0}, std::vector<double>{}}) {
    const auto axis = hbLogAxis::of(values);
    EXPECT_GT(axis.lo, 0.0);
    EXPECT_LT(axis.lo, axis.hi);
  }
}

RC_GTEST_PROP(hbLogAxis, allValuesAreWithinAndTicksIncrease, ()) {
  std::vector<double> values;
  for (const int exponent : *rc::gen::container<std::vector<int>>(rc::gen::inRange(-900, 900)))
    values.push_back(std::exp2(exponent));
  if (*rc::gen::arbitrary<bool>()) values.push_back(0.0);
  const auto axis = hbLogAxis::of(values);
  for (const double value : values) RC_ASSERT(axis.lo < axis.place(value) && axis.place(value) < axis.hi);
  RC_ASSERT(axis.ticks.size() >= 1U && axis.ticks.size() <= 14U); // three a decade of short ranges, and zero
  for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
    RC_ASSERT(axis.lo <= axis.ticks[i].value && axis.ticks[i].value <= axis.hi);
    if (i > 0) RC_ASSERT(axis.ticks[i - 1].value < axis.ticks[i].value);
  }
}

} // namespace
