#include "fitting/hbFitErrors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fitting/hbFitCases.h"

// Against the grid's own values, sample by sample; sums of some thousand squares in 64 bits.
TEST(hbFitErrors, AreThoseOfEachSample) {
  const hbFitCase fit = hbFitCase::noise({17, 9, 11}, 3);
  const hbFitSamples samples = fit.samples();
  const hbSampleOperator values(fit.set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)});
  const hbSparseGrid grid = fit.interpolated();
  const std::vector<double> surpluses(grid.surpluses(0).begin(), grid.surpluses(0).end());
  const hbFitLoss loss{hbFitLoss::Kind::huber, 0.2};
  const hbFitErrors errors = hbFitErrors::of(samples, values, surpluses, loss);

  double squares[2] = {0.0, 0.0}, costs[2] = {0.0, 0.0}, within = 0.0;
  std::int64_t counts[2] = {0, 0}, few = 0, sample = 0;
  std::vector<float> magnitudes;
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 17; ++i, ++sample) {
        const double r = grid.calcValue({i / 16.0, j / 8.0, k / 10.0}, 0) - double(fit.values[std::size_t(sample)]);
        const int which = hbFitSamples::isHeldOut(sample) ? 1 : 0;
        squares[which] += r * r;
        costs[which] += loss.cost(r);
        ++counts[which];
        if (which == 0) magnitudes.push_back(float(std::abs(r)));
        if (which == 0 && std::abs(r) <= 0.2) {
          within += r * r;
          ++few;
        }
      }
  EXPECT_NEAR(errors.fitted.rmse, std::sqrt(squares[0] / double(counts[0])), 1e-12);
  EXPECT_NEAR(errors.heldOut.rmse, std::sqrt(squares[1] / double(counts[1])), 1e-12);
  EXPECT_NEAR(errors.fitted.cost, costs[0] / double(counts[0]), 1e-12);
  EXPECT_NEAR(errors.heldOut.cost, costs[1] / double(counts[1]), 1e-12);
  EXPECT_NEAR(errors.withinThreshold, std::sqrt(within / double(few)), 1e-12);
  ASSERT_EQ(errors.magnitudes.size(), magnitudes.size());
  for (std::size_t i = 0; i < magnitudes.size(); ++i) EXPECT_NEAR(errors.magnitudes[i], magnitudes[i], 1e-6);
  EXPECT_EQ(errors.lo, double(*std::min_element(fit.values.begin(), fit.values.end())));
  EXPECT_EQ(errors.hi, double(*std::max_element(fit.values.begin(), fit.values.end())));
}

// Of more than 2^20 samples a share of these, spread irregularly: with 1.5 million, every second.
TEST(hbFitErrors, KeepSomeMagnitudesOfManySamples) {
  const hbFitCase fit = hbFitCase::noise({1500, 1000, 1}, 2);
  const hbFitSamples samples = fit.samples();
  const hbSampleOperator values(fit.set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)});
  const hbFitErrors errors =
      hbFitErrors::of(samples, values, std::vector<double>(std::size_t(fit.set.storedValues())), {});
  const double expected = 0.5 * double(samples.fittedCount());
  EXPECT_NEAR(double(errors.magnitudes.size()), expected, 5.0 * std::sqrt(0.5 * expected));
}
