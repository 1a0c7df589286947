#include "report/hbMedian.h"

#include <gtest/gtest.h>

TEST(hbMedian, IsTheMiddleOrTheMeanOfTheTwoThere) {
  EXPECT_EQ(hb::median({3.0}), 3.0);
  EXPECT_EQ(hb::median({5.0, 1.0}), 3.0);
  EXPECT_EQ(hb::median({9.0, 1.0, 4.0}), 4.0);
  EXPECT_EQ(hb::median({9.0, 1.0, 4.0, 5.0}), 4.5);
  EXPECT_EQ(hb::median({2.0, 2.0, 2.0, 7.0}), 2.0);
}
