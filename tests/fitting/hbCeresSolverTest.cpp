#include "fitting/hbCeresSolver.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <oneapi/tbb/global_control.h>

#include "fitting/hbSurplusBlocks.h"
#include "tests/fitting/hbDenseFit.h"
#include "tests/fitting/hbFitCases.h"
#include "volume/hbError.h"
#include "volume/hbMemoryMonitor.h"

namespace {

using Surpluses = std::vector<double>;

Surpluses zeros(const hbFitCase& fit) { return Surpluses(std::size_t(fit.set.storedValues())); }

Surpluses interpolation(const hbFitCase& fit) {
  const hbSparseGrid grid = fit.interpolated();
  return {grid.surpluses(0).begin(), grid.surpluses(0).end()};
}

Surpluses solved(const hbFitCase& fit, double smoothing, const hbFitLoss& loss = {}, double tolerance = 1e-9) {
  const hbFitSamples samples = fit.samples();
  const auto solution = hbCeresSolver::solve({samples, fit.set, loss, smoothing}, interpolation(fit), tolerance);
  EXPECT_TRUE(solution.converged);
  EXPECT_FALSE(solution.interrupted);
  return solution.surpluses;
}

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

hbFitCase withOutliers(const hbSize3& size, int level) {
  std::vector<float> samples = hbFitCase::smoothSamples(size);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (float& s : samples)
    if (unit(random) < 0.1F) s = 4.0F * unit(random) - 1.0F;
  return {std::move(samples), size, level};
}

/// Cancels itself after so many steps.
class CancelsAfter final : public hbProgress {
public:
  explicit CancelsAfter(int steps) : steps_(steps) {}

protected:
  void show(std::int64_t, std::int64_t) override {
    if (steps_-- == 0) cancel();
  }

private:
  int steps_;
};

/// What the solver takes, with no memory that was free before counted out.
double growthOf(const hbLeastSquares& problem, const Surpluses& start) {
  malloc_trim(0);
  hbMemoryMonitor monitor;
  hbCeresSolver::solve(problem, start, 0.5); // roughly: it takes no less
  return double(monitor.growth());
}

} // namespace

TEST(hbCeresSolver, AgreesWithADenseSolution) {
  for (const double smoothing : {0.0, 1e-6, 1e-2})
    for (const hbFitCase& fit :
         {hbFitCase::noise({17, 9, 9}, 3), hbFitCase::smooth({12, 9, 10}, 3), hbFitCase::noise({33, 1, 17}, 4),
          hbFitCase::noise({33, 2, 9}, 3), hbFitCase::noise({70, 1, 1}, 5), hbFitCase::smooth({8, 4, 2}, 1)})
      EXPECT_LE(difference(solved(fit, smoothing), dense(fit, smoothing)), kSame) << smoothing;
}

TEST(hbCeresSolver, AgreesWhereSamplesDoNotFillTheLattice) {
  const hbFitCase fit = hbFitCase::noise({12, 9, 10}, 4, hbLatticeMapping::aligned);
  EXPECT_LE(difference(solved(fit, 1e-4), dense(fit, 1e-4)), kSame);
}

TEST(hbCeresSolver, AgreesOnAnyClosedSet) {
  const hbIndexSet set = hbIndexSet::full({{2, 3, 1}, {}});
  const hbFitCase fit(hbFitCase::noise({9, 13, 7}, 1).values, {9, 13, 7}, set);
  EXPECT_LE(difference(solved(fit, 1e-5), dense(fit, 1e-5)), kSame);
}

// More nodes than samples along every axis: only smoothing makes the solution one.
TEST(hbCeresSolver, AgreesWhereNodesOutnumberSamples) {
  const hbSize3 size{6, 5, 7};
  const hbFitCase fit(hbFitCase::noise(size, 1).values, size, hbIndexSet::regular(4, {glm::ivec3(4), {}}));
  EXPECT_LE(difference(solved(fit, 1e-3), dense(fit, 1e-3)), kSame);
}

TEST(hbCeresSolver, AgreesForARobustLoss) {
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.05};
  const hbFitCase fit = withOutliers({9, 8, 9}, 2);
  EXPECT_LE(difference(solved(fit, 1e-6, loss), dense(fit, 1e-6, loss)), kSame);
}

// By the tolerance's definition the objective is no more than its square, as a share, above the least. The estimate
// behind it may be off by a factor: a tenfold tolerance must not be reached.
TEST(hbCeresSolver, KeepsTheTolerance) {
  constexpr double kTolerance = 1e-2;
  for (const hbFitCase& fit : {hbFitCase::noise({17, 9, 9}, 3), withOutliers({12, 9, 10}, 3)}) {
    const hbFitSamples samples = fit.samples();
    const hbDenseFit reference({samples, fit.set, {}, 1e-6});
    const double best = reference.objective(reference.solve());
    const double found = reference.objective(solved(fit, 1e-6, {}, kTolerance));
    EXPECT_LE(found, best * (1.0 + 100.0 * kTolerance * kTolerance));
  }
}

// Not through a value map, which would take the constant away before the fit; samples are rounded with it, so this is
// asked of the solution for the same rounded samples, less the constant.
TEST(hbCeresSolver, ConstantsAreAddedToTheFit) {
  hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  constexpr float kConstant = 0x1p20F;
  std::vector<float> raised = fit.values, back;
  for (float& v : raised) v += kConstant;
  for (const float v : raised) back.push_back(v - kConstant);
  const hbVolumeField field(hbVolume::fromSamples(fit.geometry, raised), {});
  const hbSparseGrid grid = hbSparseGrid::interpolate(field, fit.set, hbLatticeMapping::fitted);
  const hbFitSamples samples(field, grid, 0);
  Surpluses found = hbCeresSolver::solve({samples, fit.set, {}, 1e-5},
                                         Surpluses(grid.surpluses(0).begin(), grid.surpluses(0).end()), 1e-9)
                        .surpluses;
  for (std::size_t i = 0; i < 8; ++i) found[i] -= double(kConstant); // the corners are the first subspace
  EXPECT_LE(difference(found, solved({back, fit.geometry.size, 3}, 1e-5)), kSame);
}

TEST(hbCeresSolver, OfNothingButZerosItMakesZeros) {
  const hbSize3 size{9, 8, 7};
  const hbFitCase fit(std::vector<float>(std::size_t(size.x * size.y * size.z)), size, 3);
  const hbFitSamples samples = fit.samples();
  for (const hbFitLoss& loss : {hbFitLoss{}, hbFitLoss{hbFitLoss::Kind::huber, 0.1}}) {
    const auto solution = hbCeresSolver::solve({samples, fit.set, loss, 1e-6}, zeros(fit), 1e-3);
    EXPECT_TRUE(solution.converged);
    EXPECT_EQ(solution.surpluses, zeros(fit));
  }
  // From elsewhere it gets there.
  const auto solution = hbCeresSolver::solve({samples, fit.set, {}, 1e-6}, Surpluses(zeros(fit).size(), 1.0), 1e-9);
  for (const double s : solution.surpluses) EXPECT_NEAR(s, 0.0, kSame);
}

// Several minimisers: one of them, whose residual is 0 since nodes outnumber samples, and nothing on stderr.
TEST(hbCeresSolver, SingularProblemsEndSilently) {
  const hbSize3 size{6, 5, 7};
  const hbFitCase fit(hbFitCase::noise(size, 1).values, size, hbIndexSet::full({glm::ivec3(4), {}}));
  const hbFitSamples samples = fit.samples();
  const hbLeastSquares problem{samples, fit.set, {}, 0.0};
  ASSERT_GE(problem.undeterminedAxis(), 0);
  testing::internal::CaptureStderr();
  const auto solution = hbCeresSolver::solve(problem, zeros(fit), 1e-3);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  for (const double s : solution.surpluses) EXPECT_TRUE(std::isfinite(s));
  const hbDenseFit reference(problem);
  // The tolerance is a share of what is left; of 0 it is a share of nothing, so the bound is one of the start's.
  EXPECT_LE(reference.objective(solution.surpluses), 1e-6 * reference.objective(zeros(fit)));
}

TEST(hbCeresSolver, DoesNotDependOnTheNumberOfThreads) {
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.1};
  const hbFitCase fit = withOutliers({10, 11, 12}, 3);
  const Surpluses many = solved(fit, 1e-6, loss, 1e-3);
  const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(solved(fit, 1e-6, loss, 1e-3), many);
}

// Other values there, the same bits.
TEST(hbCeresSolver, DoesNotSeeWhatIsHeldOut) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  std::vector<float> other = fit.values;
  for (std::size_t i = 0; i < other.size(); ++i)
    if (hbFitSamples::isHeldOut(std::int64_t(i))) other[i] = -5.0F;
  const auto solve = [](const hbFitCase& c) {
    const hbFitSamples samples = c.samples();
    return hbCeresSolver::solve({samples, c.set, {}, 1e-6}, zeros(c), 1e-3).surpluses;
  };
  EXPECT_EQ(solve({other, fit.geometry.size, 3}), solve(fit));
}

TEST(hbCeresSolver, CancelledBeforeItHandsBackWhereItBegan) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 9}, 3);
  const hbFitSamples samples = fit.samples();
  hbProgress progress;
  progress.cancel();
  const Surpluses start(std::size_t(fit.set.storedValues()), 0.25);
  const auto solution = hbCeresSolver::solve({samples, fit.set, {}, 1e-5}, start, 1e-3, progress);
  EXPECT_TRUE(solution.interrupted);
  EXPECT_EQ(solution.surpluses, start);
}

TEST(hbCeresSolver, CancelledOnTheWayItHandsBackTheBestSoFar) {
  const hbFitCase fit = withOutliers({12, 9, 10}, 3);
  const hbFitSamples samples = fit.samples();
  const hbLeastSquares problem{samples, fit.set, {hbFitLoss::Kind::huber, 0.05}, 1e-6};
  const auto whole = hbCeresSolver::solve(problem, zeros(fit), 1e-9);
  CancelsAfter progress(1);
  const auto part = hbCeresSolver::solve(problem, zeros(fit), 1e-9, progress);
  EXPECT_TRUE(part.interrupted);
  EXPECT_LT(part.rounds, whole.rounds);
  const hbDenseFit reference(problem);
  EXPECT_LT(reference.objective(part.surpluses), reference.objective(zeros(fit)));
  EXPECT_GT(reference.objective(part.surpluses), reference.objective(whole.surpluses));
}

TEST(hbCeresSolver, RefusesSamplesThatAreNotFinite) {
  hbFitCase fit = hbFitCase::smooth({9, 8, 7}, 2);
  fit.setSample(10, NAN);
  const hbFitSamples samples = fit.samples();
  EXPECT_THROW(hbCeresSolver::solve({samples, fit.set, {}, 1e-6}, zeros(fit), 1e-3), hbError);
}

// As its header says. Sanitizers take memory of their own.
TEST(hbCeresSolver, EstimatesItsMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "memory is not the program's alone";
#endif
  const hbSize3 small{5, 5, 5};
  for (const hbFitCase& fit :
       {hbFitCase::noise({33, 17, 17}, 4), hbFitCase::noise({20, 21, 22}, 3), hbFitCase::noise({200, 101, 1}, 6),
        hbFitCase(hbFitCase::noise(small, 1).values, small, hbIndexSet::regular(7, {glm::ivec3(7), {}}))})
    for (const hbFitLoss& loss : {hbFitLoss{}, hbFitLoss{hbFitLoss::Kind::huber, 0.3}}) {
      const hbFitSamples samples = fit.samples();
      const hbLeastSquares problem{samples, fit.set, loss, 1e-3};
      const double bytes = hbCeresSolver::bytes(problem), growth = growthOf(problem, zeros(fit));
      EXPECT_LE(growth, bytes) << fit.geometry.size.x;
      EXPECT_LE(bytes, 2.0 * growth + 0x1p21) << fit.geometry.size.x;
    }
}

// The pieces, put together, are the matrix: every weight once, at the surplus it belongs to.
TEST(hbSurplusBlocks, PiecesMakeTheMatrix) {
  for (const std::int64_t edge : {1, 2, 3})
    for (const hbFitCase& fit :
         {hbFitCase::noise({9, 6, 7}, 3), hbFitCase::noise({9, 1, 12}, 3), hbFitCase::noise({2, 8, 9}, 3),
          hbFitCase::noise({7, 6, 5}, 3, hbLatticeMapping::aligned)}) {
      const hbFitSamples samples = fit.samples();
      const hbSurplusBlocks blocks(samples, fit.set, edge);
      const hbDenseFit reference({samples, fit.set, {}, 0.0});
      Surpluses surpluses = zeros(fit), inBlocks = surpluses;
      for (std::size_t i = 0; i < surpluses.size(); ++i) surpluses[i] = std::sin(double(i));
      const std::vector<std::int64_t> order = blocks.order();
      for (std::size_t i = 0; i < order.size(); ++i) inBlocks[std::size_t(order[i])] = surpluses[i];

      double sum = 0.0, pieces = 0.0, values = 0.0;
      std::vector<float> plane(std::size_t(samples.samplesOfPlane()));
      const hbSize3 tiles = blocks.tiles();
      for (std::int64_t t = 0; t < tiles.x * tiles.y * tiles.z; ++t) {
        const hbSize3 tile(t % tiles.x, t / tiles.x % tiles.y, t / (tiles.x * tiles.y));
        const std::vector<hbSize3> inTile = blocks.samplesOf(tile);
        Surpluses residuals;
        for (const hbSize3& s : inTile) {
          samples.plane(s.z, plane);
          residuals.push_back(-double(plane[std::size_t(s.x + s.y * samples.size().x)]));
        }
        blocks.forBlocks(tile, [&](const hbSurplusBlocks::Group& group, const hbSize3& node) {
          Surpluses weights(std::size_t(group.surpluses()));
          for (std::size_t row = 0; row < inTile.size(); ++row) {
            blocks.weights(group, node, inTile[row], weights);
            for (std::size_t i = 0; i < weights.size(); ++i)
              residuals[row] += weights[i] * inBlocks[std::size_t(group.begin(node)) + i];
          }
          ++pieces;
          values += double(inTile.size() * weights.size());
        });
        for (const double r : residuals) sum += 0.5 * r * r;
      }
      const double objective = reference.objective(surpluses);
      // Sums of some hundred terms in 64 bits.
      EXPECT_NEAR(sum / double(samples.fittedCount()), objective, 1e-12 * objective);
      EXPECT_EQ(blocks.counts().pieces, pieces);
      EXPECT_GE(blocks.counts().values, values);
    }
}
