#include "raycast/hbSceneDefaults.h"

#include <gtest/gtest.h>

#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeField.h"

TEST(hbSceneDefaults, TheHistogramSeesTheField) {
  const auto ball = hbAnalyticField::create("ball,radius=0.25");
  const hbHistogram h = hb::fieldHistogram(*ball, 0);
  EXPECT_EQ(h.count, 64 * 64 * 64);
  // The ball's share of the cube; a lattice of cells 1/64 counts its volume to within its surface times half a cell.
  const double volume = 4.0 / 3.0 * 3.14159265 * 0.25 * 0.25 * 0.25, surface = 4.0 * 3.14159265 * 0.25 * 0.25;
  EXPECT_NEAR(h.mean, volume, surface / 128.0);
  EXPECT_GT(h.otsuThreshold(), 0.0);
  EXPECT_LT(h.otsuThreshold(), 1.0);
}

TEST(hbSceneDefaults, SmallAndFlatFieldsAreSampledAtTheirOwnSize) {
  EXPECT_EQ(hb::fieldHistogram(*hbAnalyticField::create("smooth,size=5x3x1"), 0).count, 15);
}

TEST(hbSceneDefaults, AnOffsetMovesTheThresholdAndNothingElse) {
  // The same signal with and without 1e9 on top: a float of the sum would have no digits left for the signal.
  hbGeometry geometry;
  geometry.size = {9, 9, 9};
  std::vector<double> plain, offset;
  for (int i = 0; i < 729; ++i) {
    plain.push_back(0.125 * (i * 7919 % 64));
    offset.push_back(1e9 + plain.back());
  }
  const hbHistogram a = hb::fieldHistogram(hbVolumeField(hbVolume::fromSamples(geometry, plain)), 0);
  const hbHistogram b = hb::fieldHistogram(hbVolumeField(hbVolume::fromSamples(geometry, offset)), 0);
  EXPECT_EQ(a.bins, b.bins);
  // 1e9 has 2^-23 for its last place in 64 bits.
  EXPECT_NEAR(b.otsuThreshold() - 1e9, a.otsuThreshold(), 1e-6);
  EXPECT_NEAR(b.min - 1e9, a.min, 1e-6);
  EXPECT_NEAR(b.percentile(0.5) - 1e9, a.percentile(0.5), 1e-6);
}
