#include "sparsegrid/hbCombinationSparseGrid.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "tests/sparsegrid/hbTestCombinations.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"

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

// The scaled grid's surpluses are rounded once more than those the combination is made from.
RC_GTEST_PROP(hbCombinationSparseGrid, OfAnyCoefficientsIsTheGridOfScaledSurpluses, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const bool aligned = *rc::gen::arbitrary<bool>();
  hbSize3 size = hbTestSets::sizeOf(set);
  for (int d = 0; d < 3; ++d)
    if (aligned && set.finest()[d] > 1) --size[d];
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(size), set,
                                                      aligned ? hbLatticeMapping::aligned : hbLatticeMapping::fitted);
  const std::vector<double> coefficients =
      hbTestCombinations::coefficients(set, 1.5, *rc::gen::arbitrary<std::uint32_t>());
  const hbCombinationSparseGrid combination(grid, coefficients);
  const hbSparseGrid scaled = hbTestCombinations::scaledBy(grid, coefficients);
  const auto unit = rc::gen::map(rc::gen::inRange(0, 1 << 20), [](int v) { return float(v) / float(1 << 20); });
  const std::array<float, 3> p{*unit, *unit, *unit};
  const hbPoints point{{&p[0], 1}, {&p[1], 1}, {&p[2], 1}};
  float value, direct, semiNodal, lattice;
  combination.values(point, 0, {&value, 1});
  RC_ASSERT(value == combination.calcValue32({p[0], p[1], p[2]}, 0));
  RC_ASSERT(combination.range({{p[0], p[1], p[2]}, {1, 1, 1}}, 0).contains(value));
  scaled.values(point, 0, {&direct, 1});
  hbSemiNodalGrid(scaled).values(point, 0, {&semiNodal, 1});
  const std::array<double, 3> wide{p[0], p[1], p[2]};
  scaled.lattice({&wide[0], 1}, {&wide[1], 1}, {&wide[2], 1}, 0, &lattice, 1, 1);
  const double bound = hb::combinationBound(combination, largestNodalValue(grid)) + hb::coordinateBound(scaled) +
                       0x1p-24 * hb::amplitude(scaled);
  RC_ASSERT(std::abs(value - direct) <= bound + hb::directBound(scaled));
  RC_ASSERT(std::abs(value - semiNodal) <= bound + hb::semiNodalBound(scaled));
  double latticeBound = 0.0; // in whichever order of axes
  for (int row = 0; row < 3; ++row) latticeBound = std::max(latticeBound, hb::latticeBound(scaled, row));
  RC_ASSERT(std::abs(value - lattice) <= bound + latticeBound);
}

TEST(hbCombinationSparseGrid, RefusesOtherThanOneFiniteCoefficientAGrid) {
  const hbIndexSet set = hbIndexSet::regular(3, {});
  const hbSparseGrid grid = hbSparseGrid::interpolate(
      *hbAnalyticField::create("smooth")->withSize(hbTestSets::sizeOf(set)), set, hbLatticeMapping::fitted);
  std::vector<double> coefficients = hbTestCombinations::coefficients(set, 1.0, 1);
  EXPECT_NO_THROW(hbCombinationSparseGrid(grid, coefficients));
  coefficients[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(hbCombinationSparseGrid(grid, coefficients), hbError);
  coefficients.pop_back();
  coefficients[2] = 1.0;
  EXPECT_THROW(hbCombinationSparseGrid(grid, coefficients), hbError);
}
