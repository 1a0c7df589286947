#include "fitting/hbFitSamples.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fitting/hbFitCases.h"
#include "volume/hbError.h"

// Expected 1/16 of them, with the standard deviation of as many independent draws; 5 deviations are allowed.
TEST(hbFitSamples, HoldsOutOneInSixteen) {
  const hbFitCase fit = hbFitCase::noise({40, 30, 20}, 3);
  const hbFitSamples samples = fit.samples();
  const double count = double(samples.count()), expected = count / 16.0;
  EXPECT_NEAR(double(samples.heldOutCount()), expected, 5.0 * std::sqrt(expected * 15.0 / 16.0));
  EXPECT_EQ(samples.fittedCount() + samples.heldOutCount(), samples.count());
  std::int64_t counted = 0;
  for (std::int64_t i = 0; i < samples.count(); ++i) counted += hbFitSamples::isHeldOut(i) ? 1 : 0;
  EXPECT_EQ(counted, samples.heldOutCount());
}

TEST(hbFitSamples, GivesTheSamplesAndTheirPlaces) {
  const hbFitCase fit = hbFitCase::noise({9, 6, 4}, 3);
  std::vector<float> plane(std::size_t(fit.samples().samplesOfPlane()));
  fit.samples().plane(2, plane);
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_EQ(plane[i], fit.values[2 * plane.size() + i]);
  EXPECT_EQ(fit.samples().coordinates(1)[3], 3.0 / 5.0);
}

TEST(hbFitSamples, OfAlignedGridsAreNodes) {
  const hbFitCase fit = hbFitCase::noise({9, 6, 4}, 3, hbLatticeMapping::aligned);
  EXPECT_EQ(fit.samples().coordinates(1)[3], 3.0 / 8.0);
  EXPECT_EQ(fit.samples().coordinates(2)[3], 3.0 / 4.0);
}

TEST(hbFitSamples, RefusesTooFewAndNotFinite) {
  EXPECT_THROW(hbFitCase::noise({3, 7, 3}, 1).samples(), hbError);
  hbFitCase fit = hbFitCase::noise({9, 6, 4}, 3);
  fit.setSample(100, std::numeric_limits<float>::infinity());
  std::vector<float> plane(std::size_t(fit.samples().samplesOfPlane()));
  EXPECT_NO_THROW(fit.samples().plane(0, plane));
  EXPECT_THROW(fit.samples().plane(1, plane), hbError);
}
