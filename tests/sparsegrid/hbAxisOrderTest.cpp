#include "sparsegrid/hbAxisOrder.h"

#include <gtest/gtest.h>

TEST(hbAxisOrder, ThePlanesAreAcrossTheAxisWithTheFewestSamples) {
  const hbIndexSet set = hbIndexSet::regular(9, {});
  EXPECT_EQ(hbAxisOrder::cheapest(set, {513, 513, 513}), (hbAxisOrder{0, 1, 2}));
  EXPECT_EQ(hbAxisOrder::cheapest(set, {513, 513, 1}), (hbAxisOrder{0, 1, 2}));
  EXPECT_EQ(hbAxisOrder::cheapest(set, {513, 1, 513}), (hbAxisOrder{0, 2, 1}));
  EXPECT_EQ(hbAxisOrder::cheapest(set, {1, 513, 513}).plane, 0);
  // Nothing is won where a plane more costs little.
  EXPECT_EQ(hbAxisOrder::cheapest(set, {513, 200, 513}), (hbAxisOrder{0, 1, 2}));
}

TEST(hbAxisOrder, PutsPartsWhereTheyBelong) {
  EXPECT_EQ((hbAxisOrder{2, 0, 1}.inCube(7, 8, 9)), glm::ivec3(8, 9, 7));
}
