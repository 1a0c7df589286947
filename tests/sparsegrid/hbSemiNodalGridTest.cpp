#include "sparsegrid/hbSemiNodalGrid.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/sparsegrid/hbTestPoints.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeField.h"

namespace {

hbSparseGrid gridOf(const std::string& name, const hbIndexSet& set,
                    hbLatticeMapping mapping = hbLatticeMapping::fitted) {
  hbSize3 size = hbTestSets::sizeOf(set);
  // One sample less along refined axes: the aligned mapping then continues the volume.
  for (int d = 0; d < 3; ++d)
    if (mapping == hbLatticeMapping::aligned && set.finest()[d] > 1) --size[d];
  return hbSparseGrid::interpolate(*hbAnalyticField::create(name)->withSize(size), set, mapping);
}

/// Slopes are differences over the cells of the finest lattice.
double slopeBound(const hbSparseGrid& grid, int axis, double bound) {
  return 2.0 * bound * std::exp2(std::max(grid.indexSet().finest()[axis], 1));
}

/// Whether the rounding of a point's lattice coordinate may carry it over a kink, where slopes jump.
bool besideAKink(const hbSparseGrid& grid, const glm::dvec3& point) {
  for (int d = 0; d < 3; ++d) {
    if (grid.latticeScale()[d] == 1.0) continue; // not rounded
    const double place = std::ldexp(point[d] * grid.latticeScale()[d], grid.indexSet().finest()[d]);
    if (std::abs(place - std::nearbyint(place)) <= std::ldexp(1.0, grid.indexSet().finest()[d] - 24)) return true;
  }
  return false;
}

void expectTheReference(const hbSparseGrid& grid, const hbTestPoints& points) {
  const hbSemiNodalGrid field(grid);
  const hbTestValues<float> values(field, points.view());
  const hbTestPoints64 points64(points);
  const hbTestValues<double> values64(field, points64.view());
  const double bound = hb::semiNodalBound(grid);
  // What is stored is rounded to 32 bits, once for the surpluses' sum; the rest is in 64.
  const double bound64 = 2.0 * 0x1p-24 * hb::amplitude(grid);
  ASSERT_EQ(values.value, values.valueAgain);
  ASSERT_EQ(values64.value, values64.valueAgain);
  for (std::size_t i = 0; i < points.size(); ++i) {
    glm::dvec3 slopes;
    const double value = grid.calcValue(points.at(i), 0, slopes);
    ASSERT_NEAR(values.value[i], value, bound) << i;
    ASSERT_NEAR(values64.value[i], value, bound64) << i;
    for (int d = 0; d < 3; ++d) {
      if (!besideAKink(grid, points.at(i))) {
        ASSERT_NEAR(values.gradient(i)[d], slopes[d], slopeBound(grid, d, bound)) << i << " along "
                                                                                  << "xyz"[d];
      }
      ASSERT_NEAR(values64.gradient(i)[d], slopes[d], slopeBound(grid, d, bound64)) << i;
    }
  }
}

} // namespace

TEST(hbSemiNodalGrid, AgreesWithTheReferenceAtEveryLevel) {
  for (int n = 1; n <= 11; ++n) {
    SCOPED_TRACE(n);
    const hbSparseGrid grid = gridOf("smooth", hbIndexSet::regular(n, {}));
    expectTheReference(grid, hbTestPoints::random(500));
    expectTheReference(grid, hbTestPoints::awkward());
  }
}

RC_GTEST_PROP(hbSemiNodalGrid, AgreesForAnyIndexSetAndMapping, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto mapping = *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned);
  const hbSparseGrid grid = gridOf("vortex", set, mapping);
  expectTheReference(grid, hbTestPoints::random(40));
  expectTheReference(grid, hbTestPoints::awkward());
  RC_ASSERT(!testing::Test::HasFailure());
}

// Noise on the finest nodes of one long axis, which has not 2^l + 1 samples: the lattice coordinate is rounded, and the
// steepest hats see it.
TEST(hbSemiNodalGrid, AlignedNoiseIsWithinTheBoundsOfEveryEngine) {
  for (int d = 0; d < 3; ++d) {
    hbIndexSet::Axes axes{glm::ivec3(0), glm::bvec3(true)};
    axes.maxLevel[d] = 11;
    axes.flat[d] = false;
    const hbIndexSet set = hbIndexSet::full(axes);
    hbGeometry geometry;
    geometry.size = hbSize3(1);
    geometry.size[d] = 1707;
    std::mt19937 random(5);
    std::vector<double> nodal;
    for (std::int64_t i = 0; i < set.storedValues(); ++i) nodal.push_back(random() % 2 == 0 ? 1.0 : -1.0);
    const hbSparseGrid grid =
        hbSparseGrid::fromNodalValues({geometry, {}, hbLatticeMapping::aligned}, set, {std::move(nodal)});
    const hbTestPoints points = hbTestPoints::random(2000);
    expectTheReference(grid, points);
    const hbTestValues<float> direct(grid, points.view()), combination(hbCombinationSparseGrid(grid), points.view());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double value = grid.calcValue(points.at(i), 0);
      ASSERT_NEAR(direct.value[i], value, hb::directBound(grid));
      ASSERT_NEAR(combination.value[i], value, hb::combinationBound(set, 1.0) + hb::directBound(grid));
    }
  }
}

TEST(hbSemiNodalGrid, SaysWhatItTakesAndWhatFits) {
  const hbIndexSet set = hbIndexSet::regular(5, {});
  EXPECT_TRUE(hbSemiNodalGrid::fits(set));
  EXPECT_EQ(hbSemiNodalGrid::bytes(set, 2), 4.0 * 2.0 * double(set.storedValues()));
  // Along a flat x axis every value stands twice.
  const hbIndexSet flat = hbIndexSet::regular(5, {{0, 20, 20}, {true, false, false}});
  EXPECT_EQ(hbSemiNodalGrid::bytes(flat, 1), 2.0 * 4.0 * double(flat.storedValues()));
  // Levels 11 of y and z: 1024 x 1024 lines of 2049 values.
  EXPECT_FALSE(hbSemiNodalGrid::fits(hbIndexSet::full({{11, 11, 11}, {false, false, false}})));
  EXPECT_TRUE(hbSemiNodalGrid::fits(hbIndexSet::full({{10, 11, 11}, {false, false, false}})));
}

// A packet's last lanes may stand for no point: any number of points gives what each alone gives.
TEST(hbSemiNodalGrid, AnyNumberOfPoints) {
  const hbSemiNodalGrid field(gridOf("vortex", hbIndexSet::regular(4, {})));
  const hbTestPoints points = hbTestPoints::random(40);
  const hbTestValues<float> all(field, points.view());
  for (std::size_t count = 0; count < points.size(); ++count) {
    const hbTestValues<float> some(field, points.view().subspan(0, count));
    for (std::size_t i = 0; i < count; ++i) {
      ASSERT_EQ(some.value[i], all.value[i]);
      ASSERT_EQ(some.gradient(i), all.gradient(i));
    }
  }
}

TEST(hbSemiNodalGrid, GradientsAtKinksAreOneSidedTowardsPlus) {
  // One axis, level 1: nodes 0, 1/2, 1 with values 0, 1, 0: slopes +2, then -2. The axis may be any of the three, for
  // they are treated differently.
  for (int d = 0; d < 3; ++d) {
    hbIndexSet::Axes axes{glm::ivec3(0), glm::bvec3(true)};
    axes.maxLevel[d] = 1;
    axes.flat[d] = false;
    hbGeometry geometry;
    geometry.size = hbSize3(1);
    geometry.size[d] = 3;
    const hbSemiNodalGrid field(
        hbSparseGrid::fromNodalValues({geometry, {}, {}}, hbIndexSet::full(axes), {{0.0, 0.0, 1.0}}));
    hbTestPoints points;
    std::array<std::vector<float>*, 3> coordinates{&points.x, &points.y, &points.z};
    for (int axis = 0; axis < 3; ++axis)
      *coordinates[std::size_t(axis)] =
          axis == d ? std::vector{0.0F, 0.25F, 0.5F, 0.75F, 1.0F} : std::vector<float>(5, 0.3F);
    const hbTestValues<float> values(field, points.view());
    EXPECT_EQ(values.value, (std::vector{0.0F, 0.5F, 1.0F, 0.5F, 0.0F}));
    for (std::size_t i = 0; i < 5; ++i) {
      glm::vec3 expected(0.0F);
      expected[d] = i < 2 ? 2.0F : -2.0F;
      EXPECT_EQ(values.gradient(i), expected) << i << " along "
                                              << "xyz"[d];
    }
  }
}

RC_GTEST_PROP(hbSemiNodalGrid, LatticesAreTheValuesAtTheirPoints, ()) {
  const hbSparseGrid grid =
      gridOf("vortex", *hbTestSets::any(), *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned));
  const hbSemiNodalGrid field(grid);
  const std::vector<double> xs{0.0, 0.125, 0.3, 1.0}, ys{0.2, 0.5}, zs{0.0, 0.77, 1.0};
  constexpr std::size_t kStrideY = 5, kStrideZ = 11; // with gaps, which stay untouched
  std::vector<float> out(kStrideZ * zs.size(), -99.0F);
  field.lattice(xs, ys, zs, 0, out.data(), kStrideY, kStrideZ);
  const double tolerance = 3.0 * 0x1p-24 * hb::amplitude(grid); // what is stored, and the result
  for (std::size_t k = 0; k < zs.size(); ++k)
    for (std::size_t j = 0; j < ys.size(); ++j) {
      for (std::size_t i = 0; i < xs.size(); ++i)
        RC_ASSERT(std::abs(out[i + kStrideY * j + kStrideZ * k] - grid.calcValue({xs[i], ys[j], zs[k]}, 0)) <=
                  tolerance);
      RC_ASSERT(out[4 + kStrideY * j + kStrideZ * k] == -99.0F);
    }
}

RC_GTEST_PROP(hbSemiNodalGrid, RangesEncloseEveryValueOfTheBox, ()) {
  const hbSemiNodalGrid field(gridOf(*rc::gen::elementOf(std::vector<std::string>{"vortex", "ball", "kink"}),
                                     *hbTestSets::any(),
                                     *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned)));
  const auto unit = rc::gen::map(rc::gen::inRange(0, 1025), [](int v) { return float(v) / 1024.0F; });
  hbBox box;
  std::array<float, 3> p{};
  for (int d = 0; d < 3; ++d) {
    const auto [lo, hi] = std::minmax({*unit, *unit});
    box.lo[d] = lo;
    box.hi[d] = hi;
    p[std::size_t(d)] = std::clamp(lo + *unit * (hi - lo), lo, hi);
  }
  float value = 0.0F;
  field.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1});
  RC_ASSERT(field.range(box, 0).contains(value));
}

TEST(hbSemiNodalGrid, ARangeIsTightWhereTheFieldIsMultilinear) {
  // One block, the base grid's: the range is that of its nodes, and fourteen roundings of values up to 16.
  const hbSparseGrid grid = gridOf("multilinear", hbIndexSet::regular(1, {}));
  const hbRange range = hbSemiNodalGrid(grid).range({}, 0);
  const double slack = 14.0 * 16.0 * 0x1p-24 + 0x1p-20; // and of the ends themselves
  EXPECT_NEAR(range.lo, -6.0, slack);                   // at (0,1,1)
  EXPECT_NEAR(range.hi, 16.0, slack);                   // at (1,1,1)
}

TEST(hbSemiNodalGrid, HasEveryComponentAndTheFrameOfItsGrid) {
  hbGeometry geometry;
  geometry.size = {5, 5, 3};
  geometry.spacing = {1.0, 2.0, 3.0};
  const hbIndexSet set = hbIndexSet::regular(2, hbIndexSet::axesOf(geometry.size));
  std::vector<std::vector<double>> values(2, std::vector<double>(std::size_t(set.storedValues())));
  for (std::size_t i = 0; i < values[0].size(); ++i) {
    values[0][i] = double(i % 7);
    values[1][i] = 100.0 - double(i % 5);
  }
  const hbSparseGrid grid = hbSparseGrid::fromNodalValues({geometry, {2.0, 1.0}, {}}, set, values);
  const hbSemiNodalGrid field(grid);
  EXPECT_EQ(field.components(), 2);
  EXPECT_EQ(field.geometry(), geometry);
  EXPECT_EQ(field.valueMap().scale, grid.valueMap().scale);
  const hbTestPoints points = hbTestPoints::random(20);
  for (int c = 0; c < 2; ++c) {
    const hbTestValues<float> found(field, points.view(), c);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(found.value[i], grid.calcValue(points.at(i), c), hb::semiNodalBound(grid, c));
  }
}

TEST(hbSemiNodalGrid, TheSameValuesForAnyNumberOfThreads) {
  const hbSparseGrid grid = gridOf("vortex", hbIndexSet::regular(6, {}));
  const hbTestPoints points = hbTestPoints::random(100);
  std::vector<float> first;
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const std::vector<float> values = hbTestValues<float>(hbSemiNodalGrid(grid), points.view()).value;
    if (first.empty()) first = values;
    EXPECT_EQ(values, first) << threads;
  }
}
