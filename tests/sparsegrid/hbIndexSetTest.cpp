#include "sparsegrid/hbIndexSet.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"
#include "volume/hbError.h"

// The paper's Table 2 (with the row's missing entry restored): values of the sparse grid and the combination, component
// grids, texels of the textures padded to powers of two.
TEST(hbIndexSet, RegularSetsHaveThePublishedSizes) {
  struct Row {
    int n;
    std::int64_t stored, grids, combination, padded;
  };
  for (const Row& row :
       {Row{5, 1505, 31, 5687, 22016}, Row{6, 3713, 46, 15188, 63488}, Row{7, 8961, 64, 38868, 173056},
        Row{8, 21249, 85, 96471, 452608}, Row{9, 49665, 109, 233949, 1146880}, Row{10, 114689, 136, 557030, 2834432},
        Row{11, 262145, 166, 1306610, 6864896}, Row{12, 593921, 199, 3026945, 16351232}}) {
    const hbIndexSet set = hbIndexSet::regular(row.n, {});
    EXPECT_EQ(set.storedValues(), row.stored);
    EXPECT_EQ(std::int64_t(set.componentGrids().size()), row.grids);
    EXPECT_EQ(set.combinationValues(), row.combination);
    EXPECT_EQ(set.paddedTexels(), row.padded);
    // Closed form of the stored values, and (13): (3n^2 - 3n + 2)/2 component grids.
    EXPECT_EQ(row.stored, (std::int64_t{1} << (row.n - 1)) * (row.n * row.n + 11 * row.n + 14) + 1);
    EXPECT_EQ(row.grids, (3 * row.n * row.n - 3 * row.n + 2) / 2);
    EXPECT_EQ(set.number(), row.n);
  }
}

TEST(hbIndexSet, RegularCoefficientsAreOneMinusTwoOne) {
  for (const auto& grid : hbIndexSet::regular(6, {}).componentGrids()) {
    const int sum = grid.levels.x + grid.levels.y + grid.levels.z;
    EXPECT_EQ(grid.coefficient, sum == 8 ? 1 : sum == 7 ? -2 : 1);
    EXPECT_GE(sum, 6);
  }
  int magnitude = 0;
  for (const auto& grid : hbIndexSet::regular(11, {}).componentGrids()) magnitude += std::abs(grid.coefficient);
  EXPECT_EQ(magnitude, 221);
}

TEST(hbIndexSet, AnisotropicSetsEndAtTheLevelOfEachAxis) {
  // (lx-1)/4 + (ly-1)/2 <= 1, and z at its first level: worked out by hand.
  const hbIndexSet set = hbIndexSet::anisotropic({5, 3, 1}, {});
  EXPECT_EQ(set.finest(), glm::ivec3(5, 3, 1));
  constexpr int kMostX[] = {5, 5, 3, 1}; // beside ly = 0 to 3
  for (int x = 0; x <= 6; ++x)
    for (int y = 0; y <= 4; ++y)
      for (int z = 0; z <= 2; ++z)
        EXPECT_EQ(set.contains({x, y, z}), y <= 3 && x <= kMostX[std::min(y, 3)] && z <= 1)
            << x << " " << y << " " << z;
  // 1/3 + 2/3 and 3/19 + 16/19 are 1, which rounded sums need not be.
  EXPECT_TRUE(hbIndexSet::anisotropic({4, 4, 4}, {}).contains({2, 3, 1}));
  EXPECT_TRUE(hbIndexSet::anisotropic({20, 20, 1}, {}).contains({4, 17, 0}));
  EXPECT_FALSE(hbIndexSet::anisotropic({20, 20, 1}, {}).contains({4, 18, 0}));
  // Capped, and coarse and flat axes, which have level 0 alone.
  const hbIndexSet capped = hbIndexSet::anisotropic({7, 5, 3}, {{4, 0, 0}, {false, false, true}});
  EXPECT_EQ(capped.finest(), glm::ivec3(4, 0, 0));
  EXPECT_EQ(capped.storedValues(), 17 * 2);
}

RC_GTEST_PROP(hbIndexSet, EqualLevelsOfTheAxesGiveTheRegularSet, ()) {
  const auto axes = *hbTestSets::axes();
  const int n = *rc::gen::inRange(1, 9);
  const hbIndexSet regular = hbIndexSet::regular(n, axes), equal = hbIndexSet::anisotropic(glm::ivec3(n), axes);
  RC_ASSERT(equal.subspaces().size() == regular.subspaces().size());
  for (const hbSubspace& subspace : regular.subspaces()) RC_ASSERT(equal.contains(subspace.levels));
}

RC_GTEST_PROP(hbIndexSet, AnisotropicSetsAreClosed, ()) {
  const glm::ivec3 levels(*rc::gen::inRange(1, 12), *rc::gen::inRange(1, 12), *rc::gen::inRange(1, 12));
  const hbIndexSet set = hbIndexSet::anisotropic(levels, *hbTestSets::axes());
  std::vector<glm::ivec3> list;
  for (const hbSubspace& subspace : set.subspaces()) list.push_back(subspace.levels);
  hbIndexSet::fromList(list, set.flat(), "x"); // throws where one is missing
}

TEST(hbIndexSet, EnclosesIndices) {
  const hbIndexSet set = hbIndexSet::enclosing({{3, 1, 0}, {1, 2, 0}, {1, 1, 0}}, {false, false, true}, "x");
  EXPECT_EQ(set.storedValues(), 9 * 3 + 3 * 2);
  EXPECT_TRUE(set.contains({1, 2, 0}));
  EXPECT_FALSE(set.contains({2, 2, 0}));
  const glm::bvec3 none(false);
  EXPECT_THROW(hbIndexSet::enclosing({}, none, "x"), hbError);
  EXPECT_THROW(hbIndexSet::enclosing({{2, 2, 0}, {1, 1, 1}}, none, "x"), hbError); // (2,2,0) without (2,2,1)
  EXPECT_THROW(hbIndexSet::enclosing({{1, 0, 0}}, {true, false, false}, "x"), hbError);
  for (const int level : {-1, 21, 1 << 30}) EXPECT_THROW(hbIndexSet::enclosing({{1, level, 1}}, none, "x"), hbError);
}

TEST(hbIndexSet, AxesResolveTheSamples) {
  const auto axes = hbIndexSet::axesOf({1, 2, 3});
  EXPECT_EQ(axes.maxLevel, glm::ivec3(0, 0, 1));
  EXPECT_EQ(axes.flat, glm::bvec3(true, false, false));
  EXPECT_EQ(hbIndexSet::axesOf({181, 217, 257}).maxLevel, glm::ivec3(8, 8, 8));
  EXPECT_EQ(hbIndexSet::axesOf({258, 5, 4}).maxLevel, glm::ivec3(9, 2, 2));
}

TEST(hbIndexSet, OneSliceIsATwoDimensionalSparseGrid) {
  // Two dimensions, level 3: subspaces with max(lx,1) + max(ly,1) <= 4.
  const hbIndexSet set = hbIndexSet::regular(3, hbIndexSet::uncappedAxesOf({100, 100, 1}));
  EXPECT_EQ(set.finest(), glm::ivec3(3, 3, 0));
  EXPECT_TRUE(set.contains({3, 1, 0}));
  EXPECT_TRUE(set.contains({3, 0, 0}));
  EXPECT_FALSE(set.contains({3, 2, 0}));
  // One dimension: 2^n + 1 nodes.
  EXPECT_EQ(hbIndexSet::regular(5, hbIndexSet::uncappedAxesOf({1, 9, 1})).storedValues(), 33);
  // Nothing but two nodes an axis.
  EXPECT_EQ(hbIndexSet::regular(5, hbIndexSet::uncappedAxesOf({2, 2, 2})).storedValues(), 8);
  EXPECT_EQ(hbIndexSet::regular(5, hbIndexSet::uncappedAxesOf({1, 1, 1})).storedValues(), 1);
}

TEST(hbIndexSet, RefusesLevelsOutOfRange) {
  for (const int n : {0, -1, 21, 99}) {
    EXPECT_THROW(hbIndexSet::regular(n, {}), hbError) << n;
    for (int d = 0; d < 3; ++d) {
      glm::ivec3 levels(3);
      levels[d] = n;
      EXPECT_THROW(hbIndexSet::anisotropic(levels, {}), hbError) << n;
    }
  }
}

TEST(hbIndexSet, RefusesListsThatAreNoIndexSet) {
  const glm::bvec3 none(false);
  EXPECT_THROW(hbIndexSet::fromList({}, none, "x"), hbError);
  EXPECT_THROW(hbIndexSet::fromList({{0, 0, 0}, {0, 0, 0}}, none, "x"), hbError);            // twice
  EXPECT_THROW(hbIndexSet::fromList({{0, 0, 0}, {2, 0, 0}}, none, "x"), hbError);            // a gap
  EXPECT_THROW(hbIndexSet::fromList({{1, 0, 0}}, none, "x"), hbError);                       // level 1 without level 0
  EXPECT_THROW(hbIndexSet::fromList({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, none, "x"), hbError); // level 0 without level 1
  EXPECT_THROW(hbIndexSet::fromList({{0, 0, 21}}, none, "x"), hbError);
  EXPECT_THROW(hbIndexSet::fromList({{-1, 0, 0}}, none, "x"), hbError);
  EXPECT_THROW(hbIndexSet::fromList({{0, 0, 0}, {1, 0, 0}}, {true, false, false}, "x"), hbError);
  EXPECT_NO_THROW(hbIndexSet::fromList({{0, 0, 0}, {1, 0, 0}}, none, "x"));
}

RC_GTEST_PROP(hbIndexSet, ListsRoundTripWhateverTheirOrder, ()) {
  const hbIndexSet set = *hbTestSets::any();
  std::vector<glm::ivec3> levels;
  for (const auto& subspace : set.subspaces()) levels.insert(levels.begin(), subspace.levels);
  const hbIndexSet again = hbIndexSet::fromList(levels, set.flat(), "x");
  RC_ASSERT(again.storedValues() == set.storedValues());
  RC_ASSERT(again.subspaces().size() == set.subspaces().size());
  for (std::size_t i = 0; i < levels.size(); ++i) {
    RC_ASSERT(again.subspaces()[i].levels == set.subspaces()[i].levels);
    RC_ASSERT(again.subspaces()[i].offset == set.subspaces()[i].offset);
  }
}

RC_GTEST_PROP(hbIndexSet, EverySubspaceIsCountedOnceByTheCombination, ()) {
  const hbIndexSet set = *hbTestSets::any();
  for (const auto& subspace : set.subspaces()) {
    int sum = 0;
    for (const auto& grid : set.componentGrids())
      if (glm::all(glm::lessThanEqual(subspace.levels, grid.levels))) sum += grid.coefficient;
    RC_ASSERT(sum == 1);
  }
}

// An index's coefficient is that of the part of a cube's corners that is in the set, which is closed, too.
RC_GTEST_PROP(hbIndexSet, CoefficientsAreFromMinusTwoToOne, ()) {
  const hbIndexSet set = *hbTestSets::any();
  for (const auto& grid : set.componentGrids())
    RC_ASSERT(grid.coefficient == -2 || grid.coefficient == -1 || grid.coefficient == 1);
}

RC_GTEST_PROP(hbIndexSet, LevelsHoldEverySubspaceInOrder, ()) {
  const hbIndexSet set = *hbTestSets::any();
  std::size_t next = 0;
  int number = 0;
  for (const hbLevel& level : set.levels()) {
    RC_ASSERT(level.number > number);
    number = level.number;
    for (const hbSubspace& subspace : level.subspaces) RC_ASSERT(subspace.levels == set.subspaces()[next++].levels);
  }
  RC_ASSERT(next == set.subspaces().size());
}
