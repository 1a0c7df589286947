#include "sparsegrid/hbCombinationSparseGrid.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"

namespace {

double largestNodalValue(const hbSparseGrid& grid) {
  double largest = 0.0;
  for (const double v : grid.nodalValues(0)) largest = std::max(largest, std::abs(v));
  return largest;
}

} // namespace

TEST(hbCombinationSparseGrid, AgreesWithTheReferenceAtEveryLevel) {
  std::mt19937 random(99);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  for (int n = 1; n <= 11; ++n) {
    const hbIndexSet set = hbIndexSet::regular(n, {});
    const hbSparseGrid grid = hbSparseGrid::interpolate(
        *hbAnalyticField::create("smooth")->withSize(hbTestSets::sizeOf(set)), set, hbLatticeMapping::fitted);
    const hbCombinationSparseGrid combination(grid);
    EXPECT_EQ(combination.grids().size(), set.componentGrids().size());
    const double bound = hb::combinationBound(set, largestNodalValue(grid)) + 0x1p-24 * hb::amplitude(grid);
    for (int i = 0; i < 200; ++i) {
      const std::array<float, 3> p{unit(random), unit(random), unit(random)};
      float value, dx, dy, dz, again;
      combination.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1});
      glm::dvec3 gradient;
      ASSERT_NEAR(value, grid.calcValue({p[0], p[1], p[2]}, 0, gradient), bound) << "level " << n;
      combination.gradients({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&again, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
      ASSERT_EQ(again, value);
      // Differences of nodal values are as inexact as the values, times the cells of the finest axis.
      const double slopeBound = 2.0 * bound * std::exp2(n);
      ASSERT_NEAR(dx, gradient.x, slopeBound);
      ASSERT_NEAR(dy, gradient.y, slopeBound);
      ASSERT_NEAR(dz, gradient.z, slopeBound);
    }
  }
}

RC_GTEST_PROP(hbCombinationSparseGrid, AgreesForAnyIndexSetAndMapping, ()) {
  const hbIndexSet set = *hbTestSets::any();
  // One sample less along refined axes: the aligned mapping then continues the volume.
  const bool aligned = *rc::gen::arbitrary<bool>();
  hbSize3 size = hbTestSets::sizeOf(set);
  for (int d = 0; d < 3; ++d)
    if (aligned && set.finest()[d] > 1) --size[d];
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(size), set,
                                                      aligned ? hbLatticeMapping::aligned : hbLatticeMapping::fitted);
  const hbCombinationSparseGrid combination(grid);
  const double bound = hb::combinationBound(set, largestNodalValue(grid)) + hb::directBound(grid);
  const auto unit = rc::gen::map(rc::gen::inRange(0, 1 << 20), [](int v) { return float(v) / float(1 << 20); });
  const std::array<float, 3> p{*unit, *unit, *unit};
  float value, direct;
  combination.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1});
  grid.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&direct, 1});
  RC_ASSERT(std::abs(value - direct) <= bound);
  RC_ASSERT(combination.range({{p[0], p[1], p[2]}, {1, 1, 1}}, 0).contains(value));
}
