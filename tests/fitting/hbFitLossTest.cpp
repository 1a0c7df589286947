#include "fitting/hbFitLoss.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

hbFitLoss huber(double threshold) { return {hbFitLoss::Kind::huber, threshold}; }

} // namespace

TEST(hbFitLoss, IsAParabolaWithStraightEnds) {
  EXPECT_EQ(hbFitLoss{}.cost(-3.0), 4.5);
  EXPECT_EQ(huber(2.0).cost(-2.0), 2.0);
  EXPECT_EQ(huber(2.0).cost(5.0), 8.0);
  EXPECT_EQ(huber(2.0).cost(-5.0), 8.0);
}

// The weighted parabola lies above the loss and touches it at the residual: what makes reweighting descend.
RC_GTEST_PROP(hbFitLoss, WeightsGiveAParabolaThatTouchesFromAbove, ()) {
  const hbFitLoss loss = huber(1.5);
  const double at = 0.01 * *rc::gen::inRange(-1000, 1000), other = 0.01 * *rc::gen::inRange(-1000, 1000);
  const double weight = loss.weight(at);
  const auto parabola = [&](double r) { return loss.cost(at) + 0.5 * weight * (r * r - at * at); };
  RC_ASSERT(weight > 0.0 && weight <= 1.0);
  RC_ASSERT(parabola(other) >= loss.cost(other) - 1e-12 * (1.0 + loss.cost(other)));
}

TEST(hbFitLoss, TheThresholdIsThatOfTheMiddleMagnitude) {
  std::vector<float> magnitudes{100.0F, 0.5F, 1e9F, 0.25F, 1.0F};
  EXPECT_DOUBLE_EQ(hbFitLoss::thresholdOf(magnitudes), 1.345 * 1.4826);
  EXPECT_EQ(hbFitLoss::thresholdOf({}), 0.0);
}
