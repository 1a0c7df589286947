#include "fitting/hbConjugateGradient.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace {

/// A diagonal matrix with these eigenvalues.
struct Diagonal {
  std::vector<double> values;

  hbConjugateGradient::Operator apply() const {
    return [this](std::span<const double> in, std::span<double> out) {
      for (std::size_t i = 0; i < in.size(); ++i) out[i] = values[i] * in[i];
      return true;
    };
  }
};

} // namespace

// Four different eigenvalues: solved after four steps, and the Lanczos process knows all of them. Its rounding grows by
// no more than the condition number.
TEST(hbConjugateGradient, NeedsAStepForEachEigenvalueAndFindsTheCondition) {
  const Diagonal h{{1.0, 1.0, 2.0, 5.0, 50.0, 50.0}};
  const std::vector<double> b{1.0, -2.0, 3.0, 4.0, 5.0, 6.0}, ones(6, 1.0);
  double half = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) half += 0.5 * b[i] * b[i] / h.values[i];
  const auto result = hbConjugateGradient::solve(h.apply(), ones, b, {half, 1e-12});
  EXPECT_TRUE(result.converged);
  EXPECT_LE(result.iterations, 5);
  for (std::size_t i = 0; i < b.size(); ++i) EXPECT_NEAR(result.x[i], b[i] / h.values[i], 50.0 * 0x1p-50);
  EXPECT_NEAR(result.decrease, half, half * 0x1p-45);
  EXPECT_NEAR(result.condition, 50.0, 1e-6);
}

TEST(hbConjugateGradient, APerfectPreconditionerNeedsOneStep) {
  const Diagonal h{{1e-3, 1.0, 1e6}};
  const std::vector<double> b{1.0, 2.0, 3.0};
  const auto result = hbConjugateGradient::solve(h.apply(), h.values, b, {0.0, 1e-3});
  EXPECT_EQ(result.iterations, 1);
  EXPECT_NEAR(result.condition, 1.0, 1e-12);
  EXPECT_NEAR(result.x[0], 1000.0, 1e-10);
}

// With b in the range of a matrix that is singular there is a solution, and x stays free of what H does not know.
TEST(hbConjugateGradient, SolvesSemiDefiniteProblems) {
  const Diagonal h{{2.0, 0.0, 3.0}};
  const std::vector<double> ones(3, 1.0);
  const auto result = hbConjugateGradient::solve(h.apply(), ones, std::vector<double>{2.0, 0.0, 6.0}, {3.5, 1e-9});
  EXPECT_NEAR(result.x[0], 1.0, 1e-12);
  EXPECT_EQ(result.x[1], 0.0);
  EXPECT_NEAR(result.x[2], 2.0, 1e-12);
}

TEST(hbConjugateGradient, OfNothingIsNothing) {
  const Diagonal h{{1.0, 2.0}};
  const std::vector<double> zeros(2), ones(2, 1.0);
  const auto result = hbConjugateGradient::solve(h.apply(), ones, zeros, {0.0, 1e-3});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.x, zeros);
  EXPECT_TRUE(std::isnan(result.condition));
}

TEST(hbConjugateGradient, InterruptedKeepsTheStepsSoFar) {
  const Diagonal h{{1.0, 10.0, 100.0}};
  const std::vector<double> b{1.0, 1.0, 1.0}, ones(3, 1.0);
  int steps = 0;
  const auto result = hbConjugateGradient::solve(
      [&](std::span<const double> in, std::span<double> out) { return h.apply()(in, out) && steps++ < 2; }, ones, b,
      {0.555, 1e-9});
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_GT(result.decrease, 0.0);
}
