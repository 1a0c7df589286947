#include "volume/fields/hbAndersonMixing.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

namespace {

using Vector = std::vector<double>;

/// x -> b + D x with the fixed point 1: one number a component, repeated to fill `size`.
Vector map(const Vector& x, const Vector& factors) {
  Vector result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = factors[i % factors.size()];
    result[i] = (1.0 - d) + d * x[i];
  }
  return result;
}

double error(const Vector& x) {
  double most = 0.0;
  for (const double v : x) most = std::max(most, std::abs(v - 1.0));
  return most;
}

/// The error after `count` iterates from 0.
double errorAfter(int count, std::size_t size, std::size_t depth, const Vector& factors) {
  Vector x(size, 0.0);
  hbAndersonMixing mixing(size, depth);
  for (int i = 0; i < count; ++i) mixing.next(x, map(x, factors));
  return error(x);
}

} // namespace

TEST(hbAndersonMixing, SolvesALinearMapInAsManyStepsAsItHasFactors) {
  // Plain iteration still has 0.95^5 = 0.77 of the error.
  const Vector factors{0.95, 0.8, 0.5, -0.3};
  // Like GMRES it is exact once there are as many changes as factors, but for the floats the changes are held in: 6e-8
  // of them, times the condition of their 4 x 4 equations, at most ((1+0.3)/(1-0.95))^2 = 676 for the map's own part.
  EXPECT_GT(errorAfter(3, 40, 10, factors), 1e-3);
  EXPECT_LT(errorAfter(5, 40, 10, factors), 6e-8 * 676.0 * 10.0);
  // Longer than the pieces that threads take.
  EXPECT_LT(errorAfter(5, 50000, 10, factors), 6e-8 * 676.0 * 10.0);
}

TEST(hbAndersonMixing, ForgetsWhatIsOlderThanItsDepth) {
  const Vector factors{0.95, 0.8, 0.5, -0.3};
  // With one change only it is no longer exact, but still far ahead of plain iteration, which has 0.95^40 = 0.13.
  const double shallow = errorAfter(40, 40, 1, factors);
  EXPECT_GT(errorAfter(5, 40, 1, factors), 1e-3);
  EXPECT_LT(shallow, 0.01);
}

TEST(hbAndersonMixing, StandsDependentChanges) {
  // One factor: the second change is parallel to the first, and the equations are singular.
  Vector x(3, 0.0);
  hbAndersonMixing mixing(3, 5);
  for (int i = 0; i < 12; ++i) {
    mixing.next(x, map(x, {0.9}));
    for (const double v : x) ASSERT_TRUE(std::isfinite(v)) << i;
  }
  EXPECT_LT(error(x), 1e-12);
}

TEST(hbAndersonMixing, StartsAnewWhereResidualsGrow) {
  hbAndersonMixing mixing(1, 5);
  Vector x{0.0};
  mixing.next(x, {1.0});
  EXPECT_EQ(x, Vector{1.0}); // nothing to mix yet
  mixing.next(x, {1.5});     // residual 1, then 1/2: the secant through both
  EXPECT_EQ(x, Vector{2.0});
  mixing.next(x, {2.0 + 2.5}); // grew by 5
  EXPECT_EQ(x, Vector{4.5});
}

TEST(hbAndersonMixing, DoesNotDependOnThreads) {
  Vector first;
  for (const std::size_t threads : {1, 2, 5}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    Vector x(70000, 0.0);
    hbAndersonMixing mixing(x.size(), 3);
    for (int i = 0; i < 6; ++i) mixing.next(x, map(x, {0.95, 0.8, 0.5, -0.3}));
    if (first.empty()) first = x;
    EXPECT_TRUE(x == first) << threads;
  }
}
