#include "raycast/hbPointBatch.h"

#include <gtest/gtest.h>

TEST(hbPointBatch, ALineHasTheBitsOfItsPoints) {
  hbRaySegment ray;
  ray.origin = {0.1, -0.7, 1.3};
  ray.direction = {0.013, 0.41, -0.29};
  hbPointBatch line, points;
  points.add({9.0, 9.0, 9.0}); // forgotten
  line = points;
  points.clear();
  for (int i = 1000; i < 1037; ++i) points.add(ray.at(0.37 + double(i) * 0.0021));
  line.line(ray, 0.37, 0.0021, 1000, 37);
  EXPECT_EQ(line.size(), 37U);
  EXPECT_EQ(line.x, points.x);
  EXPECT_EQ(line.y, points.y);
  EXPECT_EQ(line.z, points.z);
}
