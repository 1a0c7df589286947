#include "fitting/hbConjugateGradientSolver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "tests/fitting/hbDenseFit.h"
#include "tests/fitting/hbFitCases.h"

namespace {

using Surpluses = std::vector<double>;

Surpluses solved(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}, double tolerance = 1e-9) {
  const hbFitSamples samples = fit.samples();
  const hbConjugateGradientSolver solver(samples, fit.set);
  const hbSparseGrid start = fit.interpolated();
  const auto solution = solver.solve({samples, fit.set, loss, smoothing},
                                     Surpluses(start.surpluses(0).begin(), start.surpluses(0).end()), {tolerance, 500});
  EXPECT_TRUE(solution.converged);
  return solution.surpluses;
}

Surpluses dense(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}) {
  const hbFitSamples samples = fit.samples();
  return hbDenseFit({samples, fit.set, loss, smoothing}).solve();
}

double largest(const Surpluses& surpluses) {
  double most = 0.0;
  for (const double s : surpluses) most = std::max(most, std::abs(s));
  return most;
}

/// The greatest difference as a share of the greatest surplus.
double difference(const Surpluses& a, const Surpluses& reference) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - reference[i]));
  return most / largest(reference);
}

constexpr double kSame = 1e-6;

hbFitCase withOutliers(const hbSize3& size, int level) {
  std::vector<float> samples = hbFitCase::smoothSamples(size);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (float& s : samples)
    if (unit(random) < 0.1F) s = 4.0F * unit(random) - 1.0F;
  return {std::move(samples), size, level};
}

} // namespace

TEST(hbConjugateGradientSolver, AgreesWithADenseSolution) {
  for (const double smoothing : {0.0, 1e-6, 1e-2})
    for (const hbFitCase& fit :
         {hbFitCase::noise({17, 9, 9}, 3), hbFitCase::smooth({12, 9, 10}, 3), hbFitCase::noise({33, 1, 17}, 4),
          hbFitCase::noise({33, 2, 9}, 3), hbFitCase::noise({70, 1, 1}, 5), hbFitCase::smooth({17, 9, 9}, 3)})
      EXPECT_LE(difference(solved(fit, smoothing), dense(fit, smoothing)), kSame) << smoothing;
}

TEST(hbConjugateGradientSolver, AgreesWhereSamplesDoNotFillTheLattice) {
  const hbFitCase fit = hbFitCase::noise({12, 9, 10}, 4, hbLatticeMapping::aligned);
  EXPECT_LE(difference(solved(fit, 1e-4), dense(fit, 1e-4)), kSame);
}

TEST(hbConjugateGradientSolver, AgreesOnAnyClosedSet) {
  const hbIndexSet set = hbIndexSet::full({{2, 3, 1}, {}});
  const hbFitCase fit(hbFitCase::noise({9, 13, 7}, 1).values, {9, 13, 7}, set);
  EXPECT_LE(difference(solved(fit, 1e-5), dense(fit, 1e-5)), kSame);
}

// More nodes than samples along every axis: only smoothing makes the solution one.
TEST(hbConjugateGradientSolver, AgreesWhereNodesOutnumberSamples) {
  const hbSize3 size{6, 5, 7};
  const hbFitCase fit(hbFitCase::noise(size, 1).values, size, hbIndexSet::regular(4, {glm::ivec3(4), {}}));
  EXPECT_LE(difference(solved(fit, 1e-3), dense(fit, 1e-3)), kSame);
}

TEST(hbConjugateGradientSolver, AgreesForARobustLoss) {
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.05};
  const hbFitCase fit = withOutliers({13, 11, 9}, 3);
  EXPECT_LE(difference(solved(fit, 1e-6, loss), dense(fit, 1e-6, loss)), kSame);
}

// The constant is a million times the data: 2^-24 of it is what a sample is rounded to, so this is asked of the
// solutions of the same rounded samples, less the constant.
TEST(hbConjugateGradientSolver, ConstantsAreAddedToTheFit) {
  hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  constexpr float kConstant = 0x1p20F;
  std::vector<float> raised = fit.values, back;
  for (float& v : raised) v += kConstant;
  for (const float v : raised) back.push_back(v - kConstant);
  // Not through a value map, which would take the constant away before the fit.
  const hbVolumeField field(hbVolume::fromSamples(fit.geometry, raised), {});
  const hbSparseGrid grid = hbSparseGrid::interpolate(field, fit.set, hbLatticeMapping::fitted);
  const hbFitSamples samples(field, grid, 0);
  const hbConjugateGradientSolver solver(samples, fit.set);
  Surpluses found =
      solver.solve({samples, fit.set, {}, 1e-5}, Surpluses(grid.surpluses(0).begin(), grid.surpluses(0).end()), {1e-9})
          .surpluses;
  for (std::size_t i = 0; i < 8; ++i) found[i] -= double(kConstant); // the corners are the first subspace
  EXPECT_LE(difference(found, solved({back, fit.geometry.size, 3}, 1e-5)), kSame);
}

TEST(hbConjugateGradientSolver, DoesNotDependOnTheNumberOfThreads) {
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.1};
  const hbFitCase fit = withOutliers({20, 21, 22}, 4);
  const Surpluses many = solved(fit, 1e-6, loss, 1e-4);
  const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(solved(fit, 1e-6, loss, 1e-4), many);
}

// What is held out must not be seen: other values there, the same bits.
TEST(hbConjugateGradientSolver, DoesNotSeeWhatIsHeldOut) {
  hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  const hbFitSamples samples = fit.samples();
  const auto solve = [&](const hbFitCase& c) {
    const hbFitSamples own = c.samples();
    return hbConjugateGradientSolver(own, c.set)
        .solve({own, c.set, {}, 1e-6}, Surpluses(std::size_t(c.set.storedValues())), {1e-6})
        .surpluses;
  };
  const Surpluses before = solve(fit);
  std::vector<float> other = fit.values;
  for (std::size_t i = 0; i < other.size(); ++i)
    if (hbFitSamples::isHeldOut(std::int64_t(i))) other[i] = -5.0F;
  EXPECT_EQ(solve({other, fit.geometry.size, 3}), before);
}

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

TEST(hbConjugateGradientSolver, CancelledHandsBackWhereItBegan) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  const hbFitSamples samples = fit.samples();
  hbProgress progress;
  progress.cancel();
  const Surpluses start(std::size_t(fit.set.storedValues()), 0.25);
  const auto solution =
      hbConjugateGradientSolver(samples, fit.set).solve({samples, fit.set, {}, 1e-5}, start, {}, progress);
  EXPECT_TRUE(solution.interrupted);
  EXPECT_EQ(solution.surpluses, start);
}
