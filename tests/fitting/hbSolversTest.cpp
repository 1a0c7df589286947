// What every way to solve the least-squares problem must do.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "fitting/hbCeresSolver.h"
#include "fitting/hbConjugateGradientSolver.h"
#include "tests/fitting/hbDenseFit.h"
#include "tests/fitting/hbFitCases.h"
#include "volume/hbError.h"

namespace {

using Surpluses = std::vector<double>;

struct Solver {
  std::string name;
  hbLeastSquares::Solution (*solve)(const hbLeastSquares& problem, const Surpluses& start, double tolerance,
                                    hbProgress& progress);
};

hbLeastSquares::Solution byCeres(const hbLeastSquares& problem, const Surpluses& start, double tolerance,
                                 hbProgress& progress) {
  return hbCeresSolver::solve(problem, start, tolerance, progress);
}

hbLeastSquares::Solution byConjugateGradients(const hbLeastSquares& problem, const Surpluses& start, double tolerance,
                                              hbProgress& progress) {
  return hbConjugateGradientSolver(problem.samples, problem.set).solve(problem, start, {tolerance, 500}, progress);
}

Surpluses interpolation(const hbFitCase& fit) {
  const hbSparseGrid grid = fit.interpolated();
  return {grid.surpluses(0).begin(), grid.surpluses(0).end()};
}

Surpluses zeros(const hbFitCase& fit) { return Surpluses(std::size_t(fit.set.storedValues())); }

Surpluses dense(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}) {
  const hbFitSamples samples = fit.samples();
  return hbDenseFit({samples, fit.set, loss, smoothing}).solve();
}

/// The greatest difference as a share of the greatest surplus.
double difference(const Surpluses& a, const Surpluses& reference) {
  double most = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::abs(a[i] - reference[i]));
    largest = std::max(largest, std::abs(reference[i]));
  }
  return most / largest;
}

// What a solver is asked for that ends at a tolerance of 1e-9: the RMS of the difference over the samples is far less.
constexpr double kSame = 1e-6;

class hbSolvers : public ::testing::TestWithParam<Solver> {
protected:
  static hbLeastSquares::Solution solve(const hbLeastSquares& problem, const Surpluses& start, double tolerance,
                                        hbProgress& progress = hbProgress::none()) {
    return GetParam().solve(problem, start, tolerance, progress);
  }

  static Surpluses solved(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}, double tolerance = 1e-9) {
    const hbFitSamples samples = fit.samples();
    const auto solution = solve({samples, fit.set, loss, smoothing}, interpolation(fit), tolerance);
    EXPECT_TRUE(solution.converged);
    EXPECT_FALSE(solution.interrupted);
    return solution.surpluses;
  }

  static void expectDense(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}) {
    EXPECT_LE(difference(solved(fit, smoothing, loss), dense(fit, smoothing, loss)), kSame) << smoothing;
  }
};

} // namespace

TEST_P(hbSolvers, AgreeWithADenseSolution) {
  for (const double smoothing : {0.0, 1e-6, 1e-2})
    for (const hbFitCase& fit :
         {hbFitCase::noise({17, 9, 9}, 3), hbFitCase::smooth({12, 9, 10}, 3), hbFitCase::noise({33, 1, 17}, 4),
          hbFitCase::noise({33, 2, 9}, 3), hbFitCase::noise({70, 1, 1}, 5), hbFitCase::smooth({8, 4, 2}, 1)})
      expectDense(fit, smoothing);
}

TEST_P(hbSolvers, AgreeWhereSamplesDoNotFillTheLattice) {
  expectDense(hbFitCase::noise({12, 9, 10}, 4, hbLatticeMapping::aligned), 1e-4);
}

TEST_P(hbSolvers, AgreeOnAnyClosedSet) {
  const hbIndexSet set = hbIndexSet::full({{2, 3, 1}, {}});
  expectDense({hbFitCase::noise({9, 13, 7}, 1).values, {9, 13, 7}, set}, 1e-5);
}

// More nodes than samples along every axis: only smoothing makes the solution one.
TEST_P(hbSolvers, AgreeWhereNodesOutnumberSamples) {
  const hbSize3 size{6, 5, 7};
  expectDense({hbFitCase::noise(size, 1).values, size, hbIndexSet::regular(4, {glm::ivec3(4), {}})}, 1e-3);
}

TEST_P(hbSolvers, AgreeForARobustLoss) {
  expectDense(hbFitCase::withOutliers({9, 8, 9}, 2), 1e-6, {hbFitLoss::Kind::huber, 0.05});
}

// By the tolerance's definition the objective is no more than its square, as a share, above the least. The estimate
// behind it may be off by a factor: a tenfold tolerance must not be reached.
TEST_P(hbSolvers, KeepTheTolerance) {
  constexpr double kTolerance = 1e-2;
  for (const hbFitCase& fit : {hbFitCase::noise({17, 9, 9}, 3), hbFitCase::withOutliers({12, 9, 10}, 3)}) {
    const hbFitSamples samples = fit.samples();
    const hbDenseFit reference({samples, fit.set, {}, 1e-6});
    const double best = reference.objective(reference.solve());
    const double found = reference.objective(solved(fit, 1e-6, {}, kTolerance));
    EXPECT_LE(found, best * (1.0 + 100.0 * kTolerance * kTolerance));
  }
}

// Not through a value map, which would take the constant away before the fit; samples are rounded with it, so this is
// asked of the solution for the same rounded samples, less the constant.
TEST_P(hbSolvers, AddConstantsToTheFit) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  constexpr float kConstant = 0x1p20F;
  std::vector<float> raised = fit.values, back;
  for (float& v : raised) v += kConstant;
  for (const float v : raised) back.push_back(v - kConstant);
  const hbVolumeField field(hbVolume::fromSamples(fit.geometry, raised), {});
  const hbSparseGrid grid = hbSparseGrid::interpolate(field, fit.set, hbLatticeMapping::fitted);
  const hbFitSamples samples(field, grid, 0);
  Surpluses found =
      solve({samples, fit.set, {}, 1e-5}, Surpluses(grid.surpluses(0).begin(), grid.surpluses(0).end()), 1e-9)
          .surpluses;
  for (std::size_t i = 0; i < 8; ++i) found[i] -= double(kConstant); // the corners are the first subspace
  EXPECT_LE(difference(found, solved({back, fit.geometry.size, 3}, 1e-5)), kSame);
}

TEST_P(hbSolvers, MakeZerosOfNothingButZeros) {
  const hbSize3 size{9, 8, 7};
  const hbFitCase fit(std::vector<float>(std::size_t(size.x * size.y * size.z)), size, 3);
  const hbFitSamples samples = fit.samples();
  for (const hbFitLoss& loss : {hbFitLoss{}, hbFitLoss{hbFitLoss::Kind::huber, 0.1}}) {
    const auto solution = solve({samples, fit.set, loss, 1e-6}, zeros(fit), 1e-3);
    EXPECT_TRUE(solution.converged);
    EXPECT_EQ(solution.surpluses, zeros(fit));
  }
  // From elsewhere they get there.
  for (const double s : solve({samples, fit.set, {}, 1e-6}, Surpluses(zeros(fit).size(), 1.0), 1e-9).surpluses)
    EXPECT_NEAR(s, 0.0, kSame);
}

TEST_P(hbSolvers, DoNotDependOnTheNumberOfThreads) {
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.1};
  const hbFitCase fit = hbFitCase::withOutliers({10, 11, 12}, 3);
  const Surpluses many = solved(fit, 1e-6, loss, 1e-3);
  const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(solved(fit, 1e-6, loss, 1e-3), many);
}

// Other values there, the same bits.
TEST_P(hbSolvers, DoNotSeeWhatIsHeldOut) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  std::vector<float> other = fit.values;
  for (std::size_t i = 0; i < other.size(); ++i)
    if (hbFitSamples::isHeldOut(std::int64_t(i))) other[i] = -5.0F;
  const auto of = [](const hbFitCase& c) {
    const hbFitSamples samples = c.samples();
    return solve({samples, c.set, {}, 1e-6}, zeros(c), 1e-3).surpluses;
  };
  EXPECT_EQ(of({other, fit.geometry.size, 3}), of(fit));
}

TEST_P(hbSolvers, CancelledHandBackWhereTheyBegan) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  const hbFitSamples samples = fit.samples();
  hbProgress progress;
  progress.cancel();
  const Surpluses start(std::size_t(fit.set.storedValues()), 0.25);
  const auto solution = solve({samples, fit.set, {}, 1e-5}, start, 1e-3, progress);
  EXPECT_TRUE(solution.interrupted);
  EXPECT_EQ(solution.surpluses, start);
}

TEST_P(hbSolvers, RefuseSamplesThatAreNotFinite) {
  hbFitCase fit = hbFitCase::smooth({9, 8, 7}, 2);
  fit.setSample(10, NAN);
  const hbFitSamples samples = fit.samples();
  EXPECT_THROW(solve({samples, fit.set, {}, 1e-6}, zeros(fit), 1e-3), hbError);
}

INSTANTIATE_TEST_SUITE_P(Ways, hbSolvers,
                         ::testing::Values(Solver{"Ceres", byCeres},
                                           Solver{"ConjugateGradients", byConjugateGradients}),
                         [](const auto& way) { return way.param.name; });
