#include "fitting/hbOpticom.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/fitting/hbFitCases.h"
#include "volume/hbError.h"
#include "volume/hbMemoryMonitor.h"

namespace {

using Solution = hbOpticom::Solution;
constexpr hbFitLoss kHuber{hbFitLoss::Kind::huber, 0.0};

/// A case with its grid, the P_l f of all fitted samples, and those samples, the slow way and in 64 bits.
struct Dense {
  hbFitCase fit;
  hbSparseGrid grid;
  Eigen::MatrixXd rows;
  Eigen::VectorXd values;

  explicit Dense(hbFitCase given) : Dense(given, given.interpolated()) {}
  Dense(hbFitCase given, const hbSparseGrid& interpolated) : fit(std::move(given)), grid(interpolated) {
    const hbFitSamples samples = fit.samples();
    const auto grids = fit.set.componentGrids();
    rows.resize(samples.fittedCount(), Eigen::Index(grids.size()));
    values.resize(samples.fittedCount());
    const hbSize3 size = samples.size();
    for (std::size_t l = 0; l < grids.size(); ++l) {
      const hbSparseGrid part = componentGrid(grids[l].levels);
      Eigen::Index row = 0;
      for (std::int64_t i = 0; i < samples.count(); ++i) {
        if (hbFitSamples::isHeldOut(i)) continue;
        glm::dvec3 point(0.0);
        const std::array<std::int64_t, 3> place{i % size.x, i / size.x % size.y, i / (size.x * size.y)};
        for (int d = 0; d < 3; ++d)
          if (size[d] > 1) point[d] = double(place[std::size_t(d)]) / double(size[d] - 1);
        rows(row, Eigen::Index(l)) = part.calcValue(point, 0);
        values[row++] = double(fit.values[std::size_t(i)]);
      }
    }
  }

  Solution solve(const hbFitLoss& loss = {}, std::int64_t most = hbOpticom::kMostSamples,
                 hbProgress& progress = hbProgress::none()) const {
    const hbFitSamples samples = fit.samples();
    return hbOpticom{grid, 0, samples, loss, most}.solve(progress);
  }

  Eigen::VectorXd interpolation() const {
    const auto grids = fit.set.componentGrids();
    Eigen::VectorXd c(Eigen::Index(grids.size()));
    for (std::size_t l = 0; l < grids.size(); ++l) c[Eigen::Index(l)] = grids[l].coefficient;
    return c;
  }
  static Eigen::VectorXd of(const std::vector<double>& c) {
    return Eigen::Map<const Eigen::VectorXd>(c.data(), Eigen::Index(c.size()));
  }
  double cost(const Eigen::VectorXd& coefficients, const hbFitLoss& loss = {}) const {
    double sum = 0.0;
    for (const double r : Eigen::VectorXd(rows * coefficients - values)) sum += loss.cost(r);
    return sum / double(values.size());
  }

private:
  /// The subspaces that are part of one component grid.
  hbSparseGrid componentGrid(const glm::ivec3& levels) const {
    const hbIndexSet part = hbIndexSet::full({levels, fit.set.flat()});
    std::vector<float> surpluses;
    for (const hbSubspace& subspace : part.subspaces()) {
      const auto from = grid.surpluses(fit.set.subspace(subspace.levels), 0);
      surpluses.insert(surpluses.end(), from.begin(), from.end());
    }
    // An aligned grid's lattice coordinates are the cube's, scaled.
    return hbSparseGrid::fromSurpluses(grid.frame(), part, {surpluses});
  }
};

/// Smooth samples of which one in twenty is anything between -10 and 10.
hbFitCase spoilt(const hbSize3& size, int level) {
  std::vector<float> samples = hbFitCase::smoothSamples(size);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> outlier(-10.0F, 10.0F);
  for (float& s : samples)
    if (random() % 20 == 0) s = outlier(random);
  return {std::move(samples), size, level};
}

/// Linear samples, which every component grid interpolates alike; but those that are no node of any are off by up to
/// `noise`. Exact in floats where `unit` is 1.
hbFitCase linear(double unit, float noise) {
  const hbSize3 size{17, 17, 17};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> off(-noise, noise);
  std::vector<float> samples;
  for (int k = 0; k < 17; ++k)
    for (int j = 0; j < 17; ++j)
      for (int i = 0; i < 17; ++i)
        samples.push_back(float(unit * (i - 2.0 * j + 0.5 * k + 40.0)) +
                          (i % 2 + j % 2 + k % 2 == 3 ? off(random) : 0.0F));
  return {std::move(samples), size, 3};
}

/// Cancelled at the count of so many units.
class CancelledAt final : public hbProgress {
public:
  CancelledAt(std::string_view what, std::int64_t units) : task_(what), units_(units) {}
  void begin(std::string_view what, std::int64_t total, std::string_view unit) override {
    hbProgress::begin(what, total, unit);
    isHere_ = what == task_;
  }

protected:
  void show(std::int64_t done, std::int64_t) override {
    if (isHere_ && done >= units_) cancel();
  }

private:
  std::string task_;
  std::int64_t units_;
  bool isHere_ = false;
};

} // namespace

// Both solve by orthogonal factors, whose relative error is at most c M K^(3/2) u (2 k + k (k + 1) |r| / (|A| |x|)),
// c a small constant (here 2, for two of them), k the condition number: Higham, Accuracy and Stability of Numerical
// Algorithms, theorems 20.1 and 20.3. With the unknowns scaled, k is that of the columns as they are, at the most.
TEST(hbOpticom, MinimisesWhatADenseReferenceDoes) {
  for (const hbFitCase& fit :
       {hbFitCase::smooth({17, 14, 20}, 3), hbFitCase::smooth({21, 14, 9}, 3, hbLatticeMapping::aligned),
        hbFitCase::noise({19, 1, 23}, 3), hbFitCase::noise({9, 2, 33}, 3)}) {
    const Dense dense(fit);
    const Eigen::VectorXd expected = dense.rows.colPivHouseholderQr().solve(dense.values);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(dense.rows);
    const Eigen::VectorXd& singular = svd.singularValues();
    const double k = singular[0] / singular[singular.size() - 1], columns = double(dense.rows.cols());
    const double residual = (dense.rows * expected - dense.values).norm() / (singular[0] * expected.norm());
    const double tolerance =
        2.0 * double(dense.rows.rows()) * std::pow(columns, 1.5) * 0x1p-53 * (2.0 * k + k * (k + 1.0) * residual);
    ASSERT_LT(tolerance, 1e-4);
    const Solution found = dense.solve();
    EXPECT_TRUE(found.converged);
    EXPECT_FALSE(found.interrupted);
    EXPECT_EQ(found.samples, dense.rows.rows());
    EXPECT_EQ(found.determined, int(columns));
    EXPECT_EQ(found.rounds, 1);
    EXPECT_LE((Dense::of(found.coefficients) - expected).norm(), tolerance * expected.norm());
    EXPECT_LT(dense.cost(expected), dense.cost(dense.interpolation()));
  }
}

// Iterations end with one that lowers the cost by less than 1e-10 of it. Should each come nine tenths as near to the
// minimum as the one before, which is slow, ten times as much is left.
TEST(hbOpticom, NoCoefficientCanBeBettered) {
  const Dense dense(spoilt({25, 20, 17}, 4));
  for (const hbFitLoss& loss : {hbFitLoss{}, kHuber, hbFitLoss{hbFitLoss::Kind::huber, 0.3}}) {
    const Solution found = dense.solve(loss);
    EXPECT_TRUE(found.converged);
    EXPECT_EQ(found.loss.kind, loss.kind);
    if (loss.threshold > 0.0) {
      EXPECT_EQ(found.loss.threshold, loss.threshold);
    }
    const auto lowered = [&](Eigen::VectorXd c) {
      const double cost = dense.cost(c, found.loss);
      double least = cost;
      for (Eigen::Index l = 0; l < c.size(); ++l)
        for (const double step : {-0.1, -1e-3, -1e-5, 1e-5, 1e-3, 0.1}) {
          const double before = c[l];
          c[l] += step;
          least = std::min(least, dense.cost(c, found.loss));
          c[l] = before;
        }
      return (cost - least) / cost;
    };
    EXPECT_LE(lowered(Dense::of(found.coefficients)), 1e-9);
    EXPECT_GT(lowered(dense.interpolation()), 1e-3);
  }
}

TEST(hbOpticom, HuberKeepsOutliersFromTheCoefficients) {
  const hbSize3 size{25, 20, 17};
  const Dense dense(spoilt(size, 4), hbFitCase::smooth(size, 4).interpolated());
  const Dense clean(hbFitCase::smooth(size, 4));
  const Solution plain = dense.solve(), robust = dense.solve(kHuber);
  EXPECT_GT(robust.rounds, 1);
  EXPECT_GT(robust.loss.threshold, 0.0);
  const double plainCost = clean.cost(Dense::of(plain.coefficients));
  const double robustCost = clean.cost(Dense::of(robust.coefficients));
  EXPECT_LT(2.0 * robustCost, plainCost);
}

TEST(hbOpticom, IsTheSameOnAnyNumberOfThreads) {
  const Dense dense(spoilt({29, 29, 29}, 3));
  std::vector<std::vector<double>> found;
  for (const std::size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(dense.solve(kHuber).coefficients);
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

// An offset binds the sum of the coefficients to 1, nothing else: the fit costs no more than the best of those without
// it. Samples and surpluses of 32 bits are off by half a unit in the last place of the offset each, the latter times
// the coefficients.
TEST(hbOpticom, LargeOffsetsAreNoObstacle) {
  const hbSize3 size{17, 14, 20};
  constexpr double kOffset = 1e6;
  std::vector<float> samples = hbFitCase::noise(size, 4).values, shifted;
  for (float& s : samples) {
    s *= 1000.0F;
    shifted.push_back(s + float(kOffset));
  }
  const Dense dense(hbFitCase(samples, size, 4));
  const Eigen::Index others = dense.rows.cols() - 1;
  const Eigen::MatrixXd differences = dense.rows.rightCols(others).colwise() - dense.rows.col(0);
  const Eigen::VectorXd best = differences.colPivHouseholderQr().solve(dense.values - dense.rows.col(0));
  const double expected =
      std::sqrt((dense.rows.col(0) + differences * best - dense.values).squaredNorm() / double(dense.values.size()));

  hbGeometry geometry;
  geometry.size = size;
  const hbVolumeField field(hbVolume::fromSamples(geometry, shifted), hbValueMap{}); // not centred
  const hbSparseGrid grid = hbSparseGrid::interpolate(field, dense.fit.set, dense.fit.mapping);
  const hbFitSamples fitted(field, grid, 0);
  const Solution found = hbOpticom{grid, 0, fitted, {}}.solve();
  const hbSparseGrid fit = hbSparseGrid::fromSurpluses(grid.frame(), grid.indexSet(), {[&] {
                                                         const auto wide =
                                                             hbOpticom::surpluses(grid, 0, found.coefficients);
                                                         return std::vector<float>(wide.begin(), wide.end());
                                                       }()});
  double sum = 0.0, magnitude = 0.0, whole = 0.0;
  for (const double c : found.coefficients) {
    magnitude += std::abs(c);
    whole += c;
  }
  for (std::int64_t i = 0; i < fitted.count(); ++i) {
    if (hbFitSamples::isHeldOut(i)) continue;
    const glm::dvec3 point(double(i % size.x) / 16.0, double(i / size.x % size.y) / 13.0,
                           double(i / (size.x * size.y)) / 19.0);
    sum += std::pow(fit.calcValue(point, 0) - double(shifted[std::size_t(i)]), 2);
  }
  const double rounding = 0x1p-24 * kOffset * (2.0 + magnitude);
  EXPECT_LT(rounding, 0.1 * expected);
  EXPECT_LE(std::sqrt(sum / double(dense.values.size())), expected + rounding);
  EXPECT_NEAR(whole, 1.0, 1e-3);
}

// Where all component grids are the same function, only the sum of their coefficients matters.
TEST(hbOpticom, DirectionsThatNothingDeterminesStayThoseOfInterpolation) {
  const Dense exact(linear(1.0, 0.0F));
  const Solution same = exact.solve();
  EXPECT_TRUE(same.converged);
  EXPECT_EQ(Dense::of(same.coefficients), exact.interpolation());
  for (const double unit : {1.0, 0.1}) {
    const Dense noisy(linear(unit, 1.0F));
    for (const hbFitLoss& loss : {hbFitLoss{}, kHuber}) {
      const Solution found = noisy.solve(loss);
      EXPECT_TRUE(found.converged);
      EXPECT_EQ(found.determined, 1);
      const Eigen::VectorXd change = Dense::of(found.coefficients) - noisy.interpolation();
      EXPECT_LT(change.norm(), 0.1);
      EXPECT_LE(noisy.cost(Dense::of(found.coefficients), found.loss), noisy.cost(noisy.interpolation(), found.loss));
    }
  }
}

TEST(hbOpticom, ConstantsAreKept) {
  const hbSize3 size{9, 9, 9};
  for (const float value : {0.0F, 0.1F, 1e30F}) {
    const Dense dense(hbFitCase(std::vector<float>(729, value), size, 3));
    for (const hbFitLoss& loss : {hbFitLoss{}, kHuber}) {
      const Solution found = dense.solve(loss);
      EXPECT_TRUE(found.converged);
      EXPECT_EQ(Dense::of(found.coefficients), dense.interpolation());
    }
  }
}

TEST(hbOpticom, FewerSamplesThanCoefficientsAreMet) {
  const Dense dense(hbFitCase::noise({17, 17, 17}, 4));
  const Solution found = dense.solve({}, 9);
  EXPECT_LE(found.samples, 9);
  EXPECT_LE(found.determined, int(found.samples));
  EXPECT_LT(found.samples, std::int64_t(found.coefficients.size()));
  EXPECT_TRUE(found.converged);
  for (const double c : found.coefficients) EXPECT_TRUE(std::isfinite(c));
}

TEST(hbOpticom, SamplesHeldOutDoNotMatter) {
  const hbFitCase fit = spoilt({20, 20, 20}, 4);
  hbFitCase other = fit;
  std::vector<float> samples = fit.values;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (hbFitSamples::isHeldOut(std::int64_t(i))) samples[i] = 1e6F;
  const Dense one(fit), two(hbFitCase(samples, {20, 20, 20}, 4), fit.interpolated());
  for (const hbFitLoss& loss : {hbFitLoss{}, kHuber})
    for (const std::int64_t most : {hbOpticom::kMostSamples, std::int64_t{1000}})
      EXPECT_EQ(one.solve(loss, most).coefficients, two.solve(loss, most).coefficients);
}

// As many as asked for, less those held out: 1/16 of them, with the deviation of independent draws, of which 5 are
// allowed. The coefficients cost more than those of all samples by about K/M of the cost in expectation; 5 times that
// is allowed.
TEST(hbOpticom, APartOfTheSamplesDoesNearlyAsWell) {
  const Dense dense(hbFitCase::noise({33, 33, 33}, 3));
  const Solution part = dense.solve({}, 8000), all = dense.solve();
  EXPECT_NEAR(double(part.samples), 7500.0, 5.0 * std::sqrt(500.0 * 15.0 / 16.0));
  const double best = dense.cost(Dense::of(all.coefficients)), found = dense.cost(Dense::of(part.coefficients));
  EXPECT_GT(found, best);
  EXPECT_LT(found, best * (1.0 + 5.0 * double(all.coefficients.size()) / double(part.samples)));
}

TEST(hbOpticom, InterruptedGivesTheBestSoFar) {
  const Dense dense(spoilt({25, 20, 17}, 4));
  for (const char* task : {"interpolating component grids", "decomposing"}) {
    CancelledAt early(task, 1);
    const Solution none = dense.solve(kHuber, hbOpticom::kMostSamples, early);
    EXPECT_TRUE(none.interrupted);
    EXPECT_FALSE(none.converged);
    EXPECT_EQ(Dense::of(none.coefficients), dense.interpolation());
  }
  CancelledAt late("fitting coefficients", 2);
  const Solution some = dense.solve(kHuber, hbOpticom::kMostSamples, late), all = dense.solve(kHuber);
  EXPECT_TRUE(some.interrupted);
  EXPECT_FALSE(some.converged);
  EXPECT_LT(some.iterations, all.iterations);
  EXPECT_LT(dense.cost(Dense::of(some.coefficients), some.loss), dense.cost(dense.interpolation(), some.loss));
}

TEST(hbOpticom, TakesNoMoreMemoryThanItSays) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory is not in the estimate";
#endif
  const hbFitCase fit = spoilt({65, 65, 65}, 5);
  const hbSparseGrid grid = fit.interpolated();
  const hbFitSamples samples = fit.samples();
  for (const hbFitLoss& loss : {hbFitLoss{}, kHuber}) {
    hbMemoryMonitor monitor;
    const Solution found = hbOpticom{grid, 0, samples, loss, 30000}.solve();
    EXPECT_LE(double(monitor.growth()), hbOpticom::bytes(fit.set, found.samples));
  }
}

TEST(hbOpticom, SaysNothing) {
  const Dense dense(hbFitCase::smooth({9, 9, 9}, 3));
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  dense.solve(kHuber);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// The combination in 64 bits, of nodal values in 32; surpluses are rounded once.
TEST(hbOpticom, ScaledSurplusesAreTheCombination) {
  for (const hbFitCase& fit :
       {spoilt({25, 20, 17}, 4), hbFitCase::noise({19, 1, 23}, 3), hbFitCase::noise({9, 2, 12}, 3)}) {
    const Dense dense(fit);
    const Solution found = dense.solve();
    const std::vector<double> wide = hbOpticom::surpluses(dense.grid, 0, found.coefficients);
    const hbSparseGrid scaled =
        hbSparseGrid::fromSurpluses(dense.grid.frame(), fit.set, {std::vector<float>(wide.begin(), wide.end())});
    const hbCombinationSparseGrid combination(dense.grid, found.coefficients);
    double largest = 0.0;
    for (const double v : dense.grid.nodalValues(0)) largest = std::max(largest, std::abs(v));
    const double bound = 0x1p-24 * (hb::amplitude(scaled) + largest * hb::amplification(combination)) + 1e-12;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 200; ++i) {
      const glm::dvec3 p(unit(random), unit(random), unit(random));
      double value;
      combination.values(hbPoints64{{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, 0, {&value, 1});
      EXPECT_NEAR(scaled.calcValue(p, 0), value, bound);
    }
  }
  const Dense dense(hbFitCase::smooth({9, 9, 9}, 3));
  EXPECT_THROW(hbOpticom::surpluses(dense.grid, 0, std::vector(2, 1.0)), hbError);
}

TEST(hbOpticom, RefusesSamplesThatAreNotFinite) {
  hbFitCase fit = hbFitCase::smooth({9, 9, 9}, 3);
  const hbSparseGrid grid = fit.interpolated();
  fit.setSample(100, std::numeric_limits<float>::quiet_NaN());
  const hbFitSamples samples = fit.samples();
  EXPECT_THROW((hbOpticom{grid, 0, samples, {}}.solve()), hbError);
}
