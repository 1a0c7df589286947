#include "raycast/hbSceneDefaults.h"

#include <gtest/gtest.h>

#include "volume/fields/hbAnalyticField.h"

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
