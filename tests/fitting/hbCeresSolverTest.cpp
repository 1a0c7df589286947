#include "fitting/hbCeresSolver.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "fitting/hbSurplusBlocks.h"
#include "tests/fitting/hbDenseFit.h"
#include "tests/fitting/hbFitCases.h"
#include "volume/hbMemoryMonitor.h"

namespace {

using Surpluses = std::vector<double>;

Surpluses zeros(const hbFitCase& fit) { return Surpluses(std::size_t(fit.set.storedValues())); }

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

TEST(hbCeresSolver, CancelledOnTheWayItHandsBackTheBestSoFar) {
  const hbFitCase fit = hbFitCase::withOutliers({12, 9, 10}, 3);
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
