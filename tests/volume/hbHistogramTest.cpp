#include "volume/hbHistogram.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "tests/volume/testFiles.h"
#include "volume/hbError.h"

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

} // namespace

TEST(hbHistogram, KnownValues) {
  const auto v = hbVolume::fromSamples<std::uint8_t>(test::sized(2, 2, 2), {2, 4, 4, 4, 5, 5, 7, 9});
  const hbHistogram h = hb::calcHistograms(v, 8)[0];
  EXPECT_EQ(h.count, 8);
  EXPECT_EQ(h.min, 2.0);
  EXPECT_EQ(h.max, 9.0);
  EXPECT_EQ(h.mean, 5.0);
  EXPECT_EQ(h.deviation, 2.0);
  // Eight intervals of 7/8 from 2: 4 is in [3.75,4.625), 5 in [4.625,5.5), 7 in [6.375,7.25).
  EXPECT_EQ(h.bins, (std::vector<std::int64_t>{1, 0, 3, 2, 0, 1, 0, 1}));
  EXPECT_TRUE(h.exact);
  EXPECT_EQ(h.fine, (std::vector<std::int64_t>{1, 0, 3, 2, 0, 1, 0, 1}));
  EXPECT_EQ(h.percentile(0.0), 2.0);
  EXPECT_EQ(h.percentile(0.125), 2.0);
  EXPECT_EQ(h.percentile(0.5), 4.0);
  EXPECT_EQ(h.percentile(0.51), 5.0);
  EXPECT_EQ(h.percentile(1.0), 9.0);
  EXPECT_EQ(h.percentile(NAN), 2.0);
}

TEST(hbHistogram, LeavesOutAndCountsWhatIsNotFinite) {
  const std::vector<float> values{1.0F, kNaN, 3.0F, kInfinity, -kInfinity, kNaN, 2.0F};
  const hbHistogram h = hb::calcHistogram(values);
  EXPECT_EQ(h.count, 3);
  EXPECT_EQ(h.nans, 2);
  EXPECT_EQ(h.infinities, 2);
  EXPECT_EQ(h.min, 1.0);
  EXPECT_EQ(h.max, 3.0);
  EXPECT_EQ(h.mean, 2.0);
  EXPECT_EQ(std::accumulate(h.bins.begin(), h.bins.end(), std::int64_t{0}), 3);
}

TEST(hbHistogram, NothingFiniteGivesNaN) {
  for (const std::vector<float>& values : {std::vector<float>{}, std::vector<float>{kNaN, kInfinity}}) {
    const hbHistogram h = hb::calcHistogram(values);
    EXPECT_EQ(h.count, 0);
    for (const double v : {h.min, h.max, h.mean, h.deviation, h.percentile(0.5), h.otsuThreshold()})
      EXPECT_TRUE(std::isnan(v));
  }
}

TEST(hbHistogram, ConstantGivesTheConstant) {
  for (const float value : {0.0F, -3.5F, 1e38F}) {
    const hbHistogram h = hb::calcHistogram(std::vector<float>(1000, value));
    EXPECT_EQ(h.min, value);
    EXPECT_EQ(h.max, value);
    EXPECT_EQ(h.bins[0], 1000);
    EXPECT_EQ(h.percentile(0.5), value);
    EXPECT_EQ(h.otsuThreshold(), value);
  }
}

TEST(hbHistogram, RangeBeyondTheLargestDouble) {
  const double most = std::numeric_limits<double>::max();
  const auto v = hbVolume::fromSamples<double>(test::sized(3, 1, 1), {-most, 0.0, most});
  const hbHistogram h = hb::calcHistograms(v, 2)[0];
  EXPECT_EQ(h.bins, (std::vector<std::int64_t>{1, 2}));
  EXPECT_EQ(h.percentile(1.0), most);
}

TEST(hbHistogram, EachComponentAndSlope) {
  auto v = hbVolume::fromSamples<std::int16_t>(test::sized(2, 1, 1), {0, 100, 10, 300}, 2);
  v.setSlopeIntercept(-0.5, 1.0);
  const auto h = hb::calcHistograms(v);
  ASSERT_EQ(h.size(), 2U);
  EXPECT_EQ(h[0].min, -4.0);
  EXPECT_EQ(h[0].max, 1.0);
  EXPECT_EQ(h[1].min, -149.0);
  EXPECT_EQ(h[1].max, -49.0);
  // One count a value that the integers can take: 0..10 and 100..300.
  EXPECT_EQ(h[0].fine.size(), 11U);
  EXPECT_EQ(h[1].fine.size(), 201U);
  EXPECT_EQ(h[1].fineStep, 0.5);
}

TEST(hbHistogram, OtsuLiesBetweenTwoClasses) {
  std::mt19937 random(1);
  std::normal_distribution<float> dark(10.0F, 1.0F), bright(30.0F, 2.0F);
  std::vector<float> values;
  for (int i = 0; i < 20000; ++i) values.push_back(i % 4 == 0 ? bright(random) : dark(random));
  const double t = hb::calcHistogram(values).otsuThreshold();
  EXPECT_GT(t, 15.0);
  EXPECT_LT(t, 23.0);

  // With an empty gap: its middle.
  const auto two = hbVolume::fromSamples<std::uint8_t>(test::sized(4, 1, 1), {10, 10, 10, 20});
  EXPECT_EQ(hb::calcHistograms(two)[0].otsuThreshold(), 14.5);
}

RC_GTEST_PROP(hbHistogram, OtsuIsTheBestThresholdOfIntegers, ()) {
  const auto samples =
      *rc::gen::nonEmpty(rc::gen::container<std::vector<std::uint8_t>>(rc::gen::arbitrary<std::uint8_t>()));
  const auto v = hbVolume::fromSamples<std::uint8_t>(test::sized(std::int64_t(samples.size()), 1, 1), samples);
  const auto between = [&](double threshold) {
    double n[2] = {0, 0}, sum[2] = {0, 0};
    for (const std::uint8_t s : samples) {
      const int side = s > threshold ? 1 : 0;
      n[side] += 1.0;
      sum[side] += s;
    }
    if (n[0] == 0.0 || n[1] == 0.0) return 0.0;
    const double apart = sum[0] / n[0] - sum[1] / n[1];
    return n[0] * n[1] * apart * apart;
  };
  double best = 0.0;
  for (int t = 0; t < 256; ++t) best = std::max(best, between(t));
  // The program sums distances from min, this test values from 0: some roundings of products below 2^16 * 100^2.
  RC_ASSERT(between(hb::calcHistograms(v)[0].otsuThreshold()) >= best * (1.0 - 1e-12));
}

RC_GTEST_PROP(hbHistogram, PercentilesAgreeWithSorting, ()) {
  const auto samples =
      *rc::gen::nonEmpty(rc::gen::container<std::vector<std::int16_t>>(rc::gen::arbitrary<std::int16_t>()));
  auto sorted = samples;
  std::sort(sorted.begin(), sorted.end());
  const double p = double(*rc::gen::inRange(1, 100)) / 128.0; // p * count is exact
  const auto rank = std::size_t(std::max(1.0, std::ceil(p * double(sorted.size()))));
  const auto v = hbVolume::fromSamples<std::int16_t>(test::sized(std::int64_t(samples.size()), 1, 1), samples);
  RC_ASSERT(hb::calcHistograms(v)[0].percentile(p) == double(sorted[rank - 1]));
  // Floats: within a fine interval, and its rounding.
  const std::vector<float> floats(samples.begin(), samples.end());
  const hbHistogram h = hb::calcHistogram(floats);
  RC_ASSERT(std::abs(h.percentile(p) - double(sorted[rank - 1])) <= h.fineStep * (1.0 + 1e-9));
}

TEST(hbHistogram, DoesNotDependOnTheThreads) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> values(300 * 40 * 50);
  for (float& v : values) v = std::exp(10.0F * normal(random));
  const auto v = hbVolume::fromSamples(test::sized(300, 40, 50), values);
  const auto with = [&](std::size_t threads) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    return hb::calcHistograms(v)[0];
  };
  const hbHistogram one = with(1), four = with(4);
  EXPECT_EQ(one.mean, four.mean);
  EXPECT_EQ(one.deviation, four.deviation);
  EXPECT_EQ(one.bins, four.bins);
  EXPECT_EQ(one.fine, four.fine);
}

TEST(hbHistogram, RowsLongerThanABlock) {
  std::vector<float> values(200001);
  std::iota(values.begin(), values.end(), 0.0F);
  const auto v = hbVolume::fromSamples(test::sized(200001, 1, 1), values);
  const hbHistogram h = hb::calcHistograms(v, 4)[0];
  EXPECT_EQ(h.count, 200001);
  EXPECT_EQ(h.mean, 100000.0); // the sum, below 2^53, is exact
  EXPECT_EQ(h.bins, (std::vector<std::int64_t>{50000, 50000, 50000, 50001}));
}

TEST(hbHistogram, CanBeCancelledAndChecksItsBins) {
  hbProgress progress;
  progress.cancel();
  const std::vector<float> values(10);
  EXPECT_THROW(hb::calcHistogram(values, 256, progress), hbCancelled);
  EXPECT_THROW(hb::calcHistogram(values, 0), hbError);
}
