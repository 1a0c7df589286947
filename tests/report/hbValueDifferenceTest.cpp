#include "report/hbValueDifference.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/report/hbTestVolumes.h"
#include "volume/hbError.h"

TEST(hbValueDifference, IsTheSumOverAllSamples) {
  // More rows than slabs, and rows longer than a piece.
  for (const hbSize3 size : {hbSize3{3, 50, 41}, hbSize3{9000, 2, 1}, hbSize3{1, 1, 1}}) {
    const hbVolume a = volumeOf(size, 1, 2), b = volumeOf(size, 2, 2);
    hbErrorStatistics expected;
    for (std::int64_t z = 0; z < size.z; ++z)
      for (std::int64_t y = 0; y < size.y; ++y)
        for (std::int64_t x = 0; x < size.x; ++x) expected.add(a.value(x, y, z, 1), b.value(x, y, z, 1));
    const hbErrorStatistics found = hb::volumeDifference(a, b, 1);
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(found.max, expected.max);
    EXPECT_EQ(found.lo, expected.lo);
    EXPECT_EQ(found.hi, expected.hi);
    // The same positive terms in another order: relative error below count * eps.
    EXPECT_NEAR(found.sumSquares, expected.sumSquares, double(expected.count) * 0x1p-53 * expected.sumSquares);
  }
}

TEST(hbValueDifference, DoesNotDependOnTheNumberOfThreads) {
  const hbVolume a = volumeOf({33, 70, 50}, 3), b = volumeOf({33, 70, 50}, 4);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return hb::volumeDifference(a, b).sumSquares;
  };
  EXPECT_EQ(with(1), with(4));
}

TEST(hbValueDifference, ComparesDataValuesNotSamples) {
  hbGeometry g;
  g.size = {2, 1, 1};
  hbVolume a = hbVolume::fromSamples<std::uint8_t>(g, {10, 20});
  a.setSlopeIntercept(0.5, 1.0);
  const auto s = hb::volumeDifference(a, hbVolume::fromSamples<double>(g, {6.0, 12.0}));
  EXPECT_EQ(s.max, 1.0);
  EXPECT_EQ(s.hi, 11.0);
}

TEST(hbValueDifference, RefusesUnlikeVolumes) {
  const hbVolume a = volumeOf({3, 4, 5}, 1);
  EXPECT_THROW(hb::volumeDifference(a, volumeOf({3, 4, 6}, 1)), hbError);
  EXPECT_THROW(hb::volumeDifference(a, a, 1), hbError);
  EXPECT_THROW(hb::volumeDifference(a, a, -1), hbError);
}

TEST(hbValueDifference, CanBeInterrupted) {
  const hbVolume a = volumeOf({3, 4, 5}, 1);
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::volumeDifference(a, a, 0, progress), hbCancelled);
}
