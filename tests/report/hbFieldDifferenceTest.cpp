#include "report/hbFieldDifference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/report/hbTestVolumes.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST(hbFieldDifference, OfAVolumeIsTheSumOverItsSamples) {
  // More rows than slabs, rows longer than a slab, and flat axes.
  for (const hbSize3 size : {hbSize3{13, 50, 7}, hbSize3{70000, 2, 1}, hbSize3{1, 5, 1}}) {
    const hbVolume reference = volumeOf(size, 1, 2), other = volumeOf(size, 2, 2);
    const hbVolumeField field(other);
    hbErrorStatistics expected;
    for (std::int64_t z = 0; z < size.z; ++z)
      for (std::int64_t y = 0; y < size.y; ++y)
        for (std::int64_t x = 0; x < size.x; ++x) expected.add(reference.value(x, y, z, 1), other.value(x, y, z, 1));
    const hbErrorStatistics found = hb::fieldVolumeDifference(reference, field, 1);
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(found.max, expected.max);
    EXPECT_EQ(found.lo, expected.lo);
    EXPECT_EQ(found.hi, expected.hi);
    // The same positive terms in another order.
    EXPECT_NEAR(found.sumSquares, expected.sumSquares, double(expected.count) * 0x1p-53 * expected.sumSquares);
  }
}

TEST(hbFieldDifference, IsInTrueValuesAndReplacesNonFiniteSamples) {
  hbGeometry g;
  g.size = {3, 1, 1};
  hbVolume reference = hbVolume::fromSamples<float>(g, {1.0F, float(kNan), 3.0F});
  reference.setSlopeIntercept(2.0, 1.0); // 3, NaN, 7
  // Seen through 10 + 4 v, the field's own values are far from the data's.
  const hbVolumeField field(hbVolume::fromSamples<float>(g, {3.5F, 50.0F, 7.0F}), {10.0, 4.0});
  EXPECT_EQ(hb::fieldVolumeDifference(reference, field, 0, 48.0).max, 2.0);
  EXPECT_EQ(hb::fieldVolumeDifference(reference, field, 0, 48.0).lo, 3.0);
  EXPECT_TRUE(std::isinf(hb::fieldVolumeDifference(reference, field, 0).max));
  const auto valueAt = [](const glm::dvec3&) { return 4.0; };
  EXPECT_EQ(hb::randomSampleDifference(reference, valueAt, 0, 1000, 4.5).max, 3.0);
  EXPECT_TRUE(std::isinf(hb::randomSampleDifference(reference, valueAt, 0, 1000).max));
}

TEST(hbFieldDifference, RandomSamplesAreSamples) {
  // At the very samples both are the same function; all of 30 samples are met by 10000 draws.
  const hbVolume reference = volumeOf({5, 3, 2}, 7, 2);
  const auto valueAt = [&](const glm::dvec3& p) {
    const glm::dvec3 place = p * glm::dvec3(4, 2, 1);
    EXPECT_NEAR(glm::distance(place, glm::round(place)), 0.0, 1e-15);
    return reference.value(std::lround(place.x), std::lround(place.y), std::lround(place.z), 1) + 0.5;
  };
  const hbErrorStatistics found = hb::randomSampleDifference(reference, valueAt, 1, 10000);
  EXPECT_EQ(found.count, 10000);
  // The sum rounds once: values below 168.
  EXPECT_NEAR(found.max, 0.5, 256 * 0x1p-53);
  EXPECT_NEAR(found.rmse(), 0.5, 256 * 0x1p-53);
  double lo = 1e9, hi = -1e9;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 5; ++x) {
        lo = std::min(lo, reference.value(x, y, z, 1));
        hi = std::max(hi, reference.value(x, y, z, 1));
      }
  EXPECT_EQ(found.lo, lo);
  EXPECT_EQ(found.hi, hi);
}

TEST(hbFieldDifference, OfFieldsIsAtRandomPoints) {
  const auto a = hbAnalyticField::create("kink"), b = hbAnalyticField::create("multilinear");
  EXPECT_EQ(hb::fieldDifference(*a, *a, 0, 5000).max, 0.0);
  const hbErrorStatistics found = hb::fieldDifference(*a, *b, 0, 50000);
  EXPECT_EQ(found.count, 50000);
  // |x+y+z-1.5| has the mean of squares 3/12; the sample mean of 50000 is within 5 of its standard deviations.
  EXPECT_NEAR(hb::fieldDifference(*a, *hbAnalyticField::create("ball,radius=0"), 0, 50000).rmse(), 0.5,
              5 * 0.5 / std::sqrt(50000.0));
  // The whole cube is met: the range of kink is [0, 1.5].
  EXPECT_LT(found.lo, 0.01);
  EXPECT_GT(found.hi, 1.2);
}

TEST(hbFieldDifference, DoesNotDependOnTheNumberOfThreads) {
  const hbVolume a = volumeOf({33, 70, 50}, 3), b = volumeOf({33, 70, 50}, 4);
  const hbVolumeField fieldA(a), fieldB(b);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return std::vector{hb::fieldVolumeDifference(a, fieldB, 0).sumSquares,
                       hb::fieldDifference(fieldA, fieldB, 0, 30000).sumSquares,
                       hb::randomSampleDifference(
                           a, [](const glm::dvec3& p) { return p.x; }, 0, 30000)
                           .sumSquares};
  };
  EXPECT_EQ(with(1), with(4));
}

TEST(hbFieldDifference, CanBeInterrupted) {
  const hbVolume a = volumeOf({3, 4, 5}, 1);
  const hbVolumeField field(a);
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::fieldVolumeDifference(a, field, 0, {}, progress), hbCancelled);
  EXPECT_THROW(hb::fieldDifference(field, field, 0, 10, progress), hbCancelled);
  EXPECT_THROW(hb::randomSampleDifference(
                   a, [](const glm::dvec3&) { return 0.0; }, 0, 10, {}, progress),
               hbCancelled);
}
