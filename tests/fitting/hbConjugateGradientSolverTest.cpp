#include "fitting/hbConjugateGradientSolver.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/fitting/hbFitCases.h"

namespace {

using Surpluses = std::vector<double>;

} // namespace

// Symmetric to rounding, and x'Hx > 0 for every x but 0: sums of squares, with smoothing or enough samples.
RC_GTEST_PROP(hbConjugateGradientSolver, TheOperatorIsSymmetricAndPositiveDefinite, ()) {
  const hbSize3 size{*rc::gen::inRange<std::int64_t>(5, 14), *rc::gen::inRange<std::int64_t>(4, 9),
                     *rc::gen::inRange<std::int64_t>(4, 9)};
  const int level = *rc::gen::inRange(1, 6);
  const hbFitCase fit =
      hbFitCase::noise(size, level, *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned));
  const double smoothing = *rc::gen::element(1e-6, 1e-3, 1.0);
  const hbFitSamples samples = fit.samples();
  const hbConjugateGradientSolver solver(samples, fit.set);
  const auto count = std::size_t(fit.set.storedValues());
  const auto numbers = [&] {
    const auto some = *rc::gen::container<std::vector<int>>(count, rc::gen::inRange(-8, 9));
    return Surpluses(some.begin(), some.end());
  };
  Surpluses x = numbers(), y = numbers(), hx(count), hy(count);
  x[0] += 16.0; // not all 0
  const hbLeastSquares problem{samples, fit.set, {}, smoothing};
  solver.apply(problem, x, hx);
  solver.apply(problem, y, hy);
  const auto dot = [](const Surpluses& a, const Surpluses& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  const double xx = dot(x, hx), yy = dot(y, hy), xy = dot(x, hy), yx = dot(y, hx);
  RC_ASSERT(xx > 0.0);
  // |x'Hy| <= sqrt(x'Hx y'Hy); rounding is a share of sums of magnitudes, which the norm of a row exceeds by the 2.8 of
  // a prewavelet's values, cubed, and the terms that meet.
  RC_ASSERT(std::abs(xy - yx) <= 1e-10 * std::sqrt(xx * yy) + 1e-12 * xx);
  RC_ASSERT(std::abs(xy) <= std::sqrt(xx * yy) * (1.0 + 1e-9));
}

// The estimate comes from below and is close: checked against all eigenvalues of the same matrix, column by column.
TEST(hbConjugateGradientSolver, EstimatesTheCondition) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  const hbFitSamples samples = fit.samples();
  const hbConjugateGradientSolver solver(samples, fit.set);
  const hbLeastSquares problem{samples, fit.set, {}, 1e-5};
  const auto count = Eigen::Index(fit.set.storedValues());
  Eigen::MatrixXd h(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    Surpluses unit(static_cast<std::size_t>(count)), column(unit.size());
    unit[std::size_t(i)] = 1.0;
    solver.apply(problem, unit, column);
    h.col(i) = Eigen::Map<Eigen::VectorXd>(column.data(), count);
  }
  // The preconditioner is the diagonal for samples none of which are held out: close to, not the same as h's own.
  const Eigen::VectorXd roots = h.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(roots.asDiagonal() * h * roots.asDiagonal()).eigenvalues();
  const double condition = eigenvalues[count - 1] / eigenvalues[0];
  const auto solution = solver.solve(problem, Surpluses(std::size_t(count)), {1e-9});
  EXPECT_GT(solution.condition, 0.7 * condition);
  EXPECT_LT(solution.condition, 1.4 * condition);
}

// What makes the method worth having: the same few steps at every level (surpluses, the other basis, need more and more
// of them).
TEST(hbConjugateGradientSolver, NeedsHardlyMoreStepsOnFinerGrids) {
  std::vector<std::int64_t> steps;
  for (const int level : {3, 4, 5}) {
    const hbSize3 size(std::int64_t(2 << level) + 1, (1 << level) + 5, (1 << level) + 1);
    const hbFitCase fit = hbFitCase::smooth(size, level);
    const hbFitSamples samples = fit.samples();
    const auto solution =
        hbConjugateGradientSolver(samples, fit.set)
            .solve({samples, fit.set, {}, 1e-9}, Surpluses(std::size_t(fit.set.storedValues())), {1e-3});
    EXPECT_TRUE(solution.converged);
    steps.push_back(solution.iterations);
  }
  EXPECT_LE(steps.back(), 60);
  EXPECT_LE(steps.back(), 2 * steps.front());
}
