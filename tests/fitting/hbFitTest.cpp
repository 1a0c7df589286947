#include "fitting/hbFit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <oneapi/tbb/global_control.h>

#include "fitting/hbConjugateGradientSolver.h"
#include "tests/fitting/hbFitCases.h"
#include "volume/hbError.h"
#include "volume/hbMemoryMonitor.h"

namespace {

std::vector<float> surplusesOf(const hbSparseGrid& grid, int component = 0) {
  return {grid.surpluses(component).begin(), grid.surpluses(component).end()};
}

hbFit::Result fitted(const hbFitCase& fit, const hbFit& how, hbProgress& progress = hbProgress::none()) {
  return how.run(fit.field(), fit.interpolated(), progress);
}

/// Against these samples, at all of them.
double rmse(const hbSparseGrid& grid, const std::vector<float>& samples) {
  const hbSize3 size = grid.geometry().size;
  std::array<std::vector<double>, 3> places;
  for (int d = 0; d < 3; ++d)
    for (std::int64_t i = 0; i < size[d]; ++i)
      places[std::size_t(d)].push_back(size[d] > 1 ? double(i) / double(size[d] - 1) : 0.0);
  std::vector<float> values(samples.size());
  grid.lattice(places[0], places[1], places[2], 0, values.data(), std::size_t(size.x), std::size_t(size.x * size.y));
  double sum = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) sum += std::pow(double(values[i]) - double(samples[i]), 2);
  return std::sqrt(sum / double(samples.size()));
}

std::string errorOf(const hbFitCase& fit, const hbFit& how) {
  try {
    fitted(fit, how);
  } catch (const hbError& error) {
    return error.what();
  }
  return "";
}

/// Stops whatever counts on it after some steps.
class Impatient final : public hbProgress {
public:
  explicit Impatient(std::int64_t steps) : left_(steps) {}

private:
  void show(std::int64_t, std::int64_t) override {
    if (--left_ <= 0) cancel();
  }
  std::int64_t left_;
};

/// A share of samples replaced by any values of their range.
std::vector<float> spoiled(std::vector<float> samples, float share) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  const auto [lo, hi] = std::minmax_element(samples.begin(), samples.end());
  const float first = *lo, range = *hi - *lo;
  for (float& s : samples)
    if (unit(random) < share) s = first + range * unit(random);
  return samples;
}

} // namespace

// Noise that no grid follows: the fit's error tends to the noise's deviation, interpolation adds that of the nodes.
TEST(hbFit, FitsBetterThanInterpolationWhereThatAliases) {
  const hbFitCase fit = hbFitCase::noise({33, 33, 33}, 4);
  const auto [grid, reports] = fitted(fit, {});
  const hbFitReport& report = reports.front();
  EXPECT_TRUE(report.improved);
  EXPECT_TRUE(report.converged);
  EXPECT_FALSE(report.interrupted);
  EXPECT_EQ(report.method, "least-squares");
  EXPECT_EQ(report.unknowns, fit.set.storedValues());
  EXPECT_EQ(report.samples + report.heldOut, 33 * 33 * 33);
  EXPECT_GT(report.iterations, 0);
  EXPECT_GE(report.condition, 1.0);
  // Uniform in [0,1): a deviation of 0.289. 593 unknowns of 33,691 samples take 1 % of it off, and add 1 % elsewhere;
  // a held-out RMSE of 2,246 samples is known to 1 %.
  EXPECT_NEAR(report.heldOutErrors.rmse, 0.289, 0.03 * 0.289);
  EXPECT_GT(report.interpolationHeldOutErrors.rmse, 1.2 * report.heldOutErrors.rmse);
  EXPECT_LT(rmse(grid, fit.values), rmse(fit.interpolated(), fit.values));
  EXPECT_NEAR(report.heldOutErrors.cost, 0.5 * std::pow(report.heldOutErrors.rmse, 2), 1e-12);
}

TEST(hbFit, KeepsInterpolationWhereItIsExact) {
  std::vector<float> samples;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 17; ++i) samples.push_back(float(i + 2 * j - k));
  const hbFitCase linear(samples, {17, 9, 9}, 3), constant(std::vector<float>(1377, 7.0F), {17, 9, 9}, 3);
  for (const hbFitCase& fit : {linear, constant})
    for (const auto loss : {hbFitLoss::Kind::none, hbFitLoss::Kind::huber}) {
      hbFit how;
      how.loss = loss;
      const auto [grid, reports] = fitted(fit, how);
      EXPECT_FALSE(reports.front().improved);
      EXPECT_EQ(surplusesOf(grid), surplusesOf(fit.interpolated()));
    }
}

// A smooth field with one sample in ten spoiled. Interpolation takes them over, plain least squares is drawn to the
// middle of their range by a tenth of the distance.
TEST(hbFit, ARobustLossLeavesOutliersOut) {
  const hbSize3 size{33, 33, 17};
  const std::vector<float> clean = hbFitCase::smoothSamples(size);
  const hbFitCase fit(spoiled(clean, 0.1F), size, 4);
  hbFit how;
  const auto plain = fitted(fit, how);
  how.loss = hbFitLoss::Kind::huber;
  const auto robust = fitted(fit, how);
  EXPECT_TRUE(robust.reports.front().improved);
  EXPECT_GT(robust.reports.front().loss.threshold, 0.0);
  EXPECT_GT(robust.reports.front().rounds, 3);
  EXPECT_LT(rmse(robust.grid, clean), rmse(fit.interpolated(), clean) / 3.0);
  EXPECT_LT(rmse(robust.grid, clean), rmse(plain.grid, clean) / 2.0);
}

// Rounding is noise of its own beside the residuals: their squares add. All surpluses are multiples
// of one power of two, not below 2^-16 of the residuals.
TEST(hbFit, RoundsSurplusesToWhatShows) {
  const hbFitCase fit = hbFitCase::noise({33, 33, 33}, 4);
  hbFit how;
  how.smoothing = 1e-9;
  const auto [grid, reports] = fitted(fit, how);
  const double step = std::ldexp(1.0, int(std::floor(std::log2(reports.front().fitted.rmse))) - 15);
  const auto isMultiple = [&](double s, double of) { return s / of == std::nearbyint(s / of); };
  const std::vector<float> surpluses = surplusesOf(grid);
  EXPECT_TRUE(std::all_of(surpluses.begin(), surpluses.end(), [&](float s) { return isMultiple(double(s), step); }));
  const hbFitSamples samples = fit.samples();
  const hbSparseGrid start = fit.interpolated();
  const auto exact = hbConjugateGradientSolver(samples, fit.set)
                         .solve({samples, fit.set, {}, 1e-9},
                                std::vector<double>(start.surpluses(0).begin(), start.surpluses(0).end()), {1e-3});
  const hbSampleOperator values(fit.set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)});
  std::vector<double> difference(exact.surpluses);
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= double(surpluses[i]);
  // (exact residuals are smaller than those reported by no more than that)
  EXPECT_LE(values.rootMeanSquare(difference), hbFit::kRounding * reports.front().fitted.rmse);
  EXPECT_GT(values.rootMeanSquare(difference),
            0.2 * hbFit::kRounding * reports.front().fitted.rmse); // no finer than need be
}

TEST(hbFit, OfNothingButOutliersIsSound) {
  for (const auto loss : {hbFitLoss::Kind::none, hbFitLoss::Kind::huber}) {
    hbFit how;
    how.loss = loss;
    const hbFitCase fit = hbFitCase::noise({11, 10, 10}, 5); // more nodes than samples
    const auto [grid, reports] = fitted(fit, how);
    EXPECT_TRUE(reports.front().converged);
    // Some mean of uniform noise, and no interpolant of it: whatever is smoothed, it stays near the range.
    const hbRange range = grid.range({}, 0);
    EXPECT_TRUE(std::isfinite(range.lo) && std::isfinite(range.hi));
    EXPECT_LE(rmse(grid, fit.values), 1.001 * rmse(fit.interpolated(), fit.values));
  }
}

// With nearly as many nodes as samples, noise wants to be smoothed and smooth data do not.
TEST(hbFit, SmoothsByWhatTheHeldOutSamplesSay) {
  const auto smoothing = [](const hbFitCase& fit) { return fitted(fit, {}).reports.front().smoothing; };
  EXPECT_GE(smoothing(hbFitCase::noise({11, 10, 10}, 4)), 256.0 * smoothing(hbFitCase::smooth({11, 10, 10}, 4)));
  hbFit given;
  given.smoothing = 0.125;
  EXPECT_EQ(fitted(hbFitCase::noise({11, 10, 10}, 3), given).reports.front().smoothing, 0.125);
}

TEST(hbFit, SmoothingOfZeroNeedsSamplesForEveryNode) {
  hbFit how;
  how.smoothing = 0.0;
  EXPECT_EQ(errorOf(hbFitCase::noise({17, 9, 9}, 4), how), "");
  EXPECT_EQ(errorOf(hbFitCase::noise({33, 6, 9}, 4), how),
            "smoothing: expected more than 0, found 0: along y the grid has more nodes than its 6 samples determine");
}

TEST(hbFit, RefusesWhatTheMemoryDoesNotHold) {
  const hbFitCase fit = hbFitCase::noise({17, 17, 17}, 4);
  hbFit how;
  how.memoryLimit = std::uint64_t(how.bytes(fit.set, fit.geometry.size) - 1.0);
  EXPECT_NE(errorOf(fit, how).find("fit: needs about "), std::string::npos);
  how.memoryLimit += 1;
  EXPECT_EQ(errorOf(fit, how), "");
}

// Both minimise the same to a millionth of the objective; what they keep is rounded by a tenth of the residuals.
TEST(hbFit, BothSolversFindTheSameFit) {
  for (const auto loss : {hbFitLoss::Kind::none, hbFitLoss::Kind::huber}) {
    const hbFitCase fit(spoiled(hbFitCase::smoothSamples({17, 15, 13}), 0.1F), {17, 15, 13}, 3);
    hbFit how;
    how.loss = loss;
    how.smoothing = 1e-6;
    how.threshold = 0.1;
    how.solver = hbFit::Solver::ceres;
    const auto ceres = fitted(fit, how);
    how.solver = hbFit::Solver::conjugateGradient;
    const auto own = fitted(fit, how);
    EXPECT_EQ(ceres.reports.front().solver, "ceres");
    EXPECT_EQ(own.reports.front().solver, "conjugate-gradient");
    EXPECT_NEAR(ceres.reports.front().fitted.cost, own.reports.front().fitted.cost,
                0.02 * own.reports.front().fitted.cost);
    const std::vector<float> a = surplusesOf(ceres.grid), b = surplusesOf(own.grid);
    std::vector<double> difference(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) difference[i] = double(a[i]) - double(b[i]);
    const hbFitSamples samples = fit.samples();
    const hbSampleOperator values(fit.set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)});
    EXPECT_LE(values.rootMeanSquare(difference), 2.02 * hbFit::kRounding * own.reports.front().fitted.rmse);
  }
}

TEST(hbFit, TakesCeresWhereItIsSmall) {
  hbFit how;
  how.smoothing = 1e-6;
  const hbFitReport small = fitted(hbFitCase::noise({11, 10, 10}, 2), how).reports.front();
  EXPECT_EQ(small.solver, "ceres");
  EXPECT_GE(small.condition, 1.0);
  EXPECT_EQ(fitted(hbFitCase::noise({33, 33, 33}, 4), how).reports.front().solver, "conjugate-gradient");
  how.solver = hbFit::Solver::ceres;
  how.memoryLimit = std::uint64_t{1} << 20;
  EXPECT_NE(errorOf(hbFitCase::noise({13, 13, 13}, 3), how).find("fit: needs about "), std::string::npos);
  how.solver = hbFit::Solver::automatic;
  EXPECT_EQ(fitted(hbFitCase::noise({13, 13, 13}, 3), how).reports.front().solver, "conjugate-gradient");
}

TEST(hbFit, RefusesWhatIsNoFit) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const hbFitCase fit = hbFitCase::noise({11, 10, 10}, 2);
  for (const double bad : {nan, infinity, -1.0}) {
    hbFit how;
    how.smoothing = bad;
    EXPECT_NE(errorOf(fit, how).find("smoothing: expected a number from 0 on, found "), std::string::npos);
    how = {};
    how.loss = hbFitLoss::Kind::huber;
    how.threshold = bad;
    EXPECT_NE(errorOf(fit, how).find("loss threshold: expected a number above 0, found "), std::string::npos);
  }
  EXPECT_EQ(errorOf(hbFitCase::noise({10, 10, 10}, 2), {}),
            "fit: expected 1024 samples at least, some of which can be held out, found 1000");
}

// One plane of a flat, wide volume is all there is, and each thread holds one. Of memory that is not counted (the
// samples' own, stacks, what the allocator keeps) there is less than 4 MB.
TEST(hbFit, TakesNoMoreMemoryThanItSays) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers have memory of their own";
#endif
  const hbFitCase fit = hbFitCase::noise({1200, 1100, 1}, 4);
  const hbSparseGrid start = fit.interpolated();
  for (const auto loss : {hbFitLoss::Kind::none, hbFitLoss::Kind::huber}) {
    hbFit how;
    how.loss = loss;
    how.smoothing = 1e-6;
    malloc_trim(0); // memory that was free before does not grow
    hbMemoryMonitor memory;
    (void)how.run(fit.field(), start);
    EXPECT_LE(double(memory.growth()), how.bytes(fit.set, fit.geometry.size) + 4.0 * 0x1p20);
    EXPECT_GE(double(memory.growth()), 0.4 * how.bytes(fit.set, fit.geometry.size));
  }
}

// Nothing was fitted: interpolation, unrounded, is what there is.
TEST(hbFit, InterruptedBeforeItBeganItKeepsInterpolation) {
  const hbFitCase fit = hbFitCase::noise({17, 15, 13}, 3);
  for (const auto method : {hbFit::Method::opticom, hbFit::Method::leastSquares}) {
    hbProgress progress;
    progress.cancel();
    hbFit how;
    how.method = method;
    how.keepBest = true;
    const auto [grid, reports] = fitted(fit, how, progress);
    EXPECT_TRUE(reports.front().interrupted);
    EXPECT_FALSE(reports.front().improved);
    EXPECT_EQ(surplusesOf(grid), surplusesOf(fit.interpolated()));
  }
}

TEST(hbFit, RefusesSamplesThatAreNotFinite) {
  hbFitCase fit = hbFitCase::noise({11, 10, 10}, 2);
  const hbSparseGrid grid = fit.interpolated();
  fit.setSample(13, std::nanf(""));
  EXPECT_THROW(hbFit{}.run(fit.field(), grid), hbError);
}

// Each component by itself, and errors in data values: of 64-bit samples on a large constant, and of their double.
TEST(hbFit, FitsEachComponentInDataValues) {
  const hbFitCase one = hbFitCase::noise({17, 9, 9}, 3);
  constexpr double kConstant = 1e9;
  std::vector<double> samples;
  for (const float v : one.values) {
    samples.push_back(kConstant + double(v));
    samples.push_back(kConstant + 2.0 * double(v));
  }
  const hbVolumeField field(hbVolume::fromSamples(one.geometry, samples, 2));
  ASSERT_FALSE(field.valueMap().isIdentity());
  const auto [grid, reports] = hbFit{}.run(field, hbSparseGrid::interpolate(field, one.set, one.mapping));
  ASSERT_EQ(reports.size(), 2U);
  // The map's floats, and 64-bit samples of 1e9, keep 2^-23 of the range. The surpluses' step is another one under
  // another map: each adds up to 0.5 % (0.1^2 / 2) to the RMSE.
  const double expected = fitted(one, {}).reports.front().heldOutErrors.rmse;
  EXPECT_NEAR(reports[0].heldOutErrors.rmse, expected, 0.005 * expected + 0x1p-20);
  EXPECT_NEAR(reports[1].heldOutErrors.rmse, 2.0 * expected, 0.01 * expected + 0x1p-19);
  EXPECT_EQ(grid.valueMap(), field.valueMap());
}

TEST(hbFit, DoesNotDependOnTheNumberOfThreads) {
  const hbSize3 size{21, 20, 19};
  const hbFitCase fit(spoiled(hbFitCase::smoothSamples(size), 0.1F), size, 4);
  hbFit how;
  how.loss = hbFitLoss::Kind::huber;
  const std::vector<float> many = surplusesOf(fitted(fit, how).grid);
  const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(surplusesOf(fitted(fit, how).grid), many);
}

TEST(hbFit, CancelledThrowsOrHandsBackTheBestSoFar) {
  const hbFitCase fit = hbFitCase::noise({33, 33, 17}, 5);
  hbFit how;
  Impatient first(6);
  EXPECT_THROW(fitted(fit, how, first), hbCancelled);
  how.keepBest = true;
  Impatient second(6);
  const auto [grid, reports] = fitted(fit, how, second);
  EXPECT_TRUE(reports.front().interrupted);
  EXPECT_FALSE(reports.front().converged);
  EXPECT_TRUE(reports.front().improved);
  EXPECT_LT(reports.front().heldOutErrors.rmse, reports.front().interpolationHeldOutErrors.rmse);
}
