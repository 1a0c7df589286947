#include "sparsegrid/hbSparseGrid.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "tests/sparsegrid/hbTestPoints.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace {

using hb::directBound;

hbGeometry cubeOf(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  return g;
}

hbSparseGrid gridOf(const std::string& name, const hbIndexSet& set) {
  return hbSparseGrid::interpolate(*hbAnalyticField::create(name)->withSize(hbTestSets::sizeOf(set)), set,
                                   hbLatticeMapping::fitted);
}

/// The definition, written again without any of the library's evaluation: sum over all subspaces and all their nodes of
/// surplus times the product of hats.
double naive(const hbSparseGrid& grid, const glm::dvec3& p, int component = 0) {
  const auto hat = [&](int d, int level, std::int64_t k) {
    const double u = p[d] * grid.latticeScale()[d];
    if (grid.indexSet().flat()[d]) return 1.0;
    if (level == 0) return k == 0 ? 1.0 - u : u;
    return std::max(0.0, 1.0 - std::abs(std::ldexp(u, level) - double(2 * k + 1)));
  };
  double sum = 0.0;
  for (const hbSubspace& s : grid.indexSet().subspaces()) {
    std::size_t at = 0;
    for (std::int64_t k = 0; k < s.nodes.z; ++k)
      for (std::int64_t j = 0; j < s.nodes.y; ++j)
        for (std::int64_t i = 0; i < s.nodes.x; ++i)
          sum += double(grid.surpluses(s, component)[at++]) * hat(0, s.levels.x, i) * hat(1, s.levels.y, j) *
                 hat(2, s.levels.z, k);
  }
  return sum;
}

} // namespace

RC_GTEST_PROP(hbSparseGrid, TheReferenceIsTheDefinition, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const hbSparseGrid grid = gridOf("vortex", set);
  const hbTestPoints points = hbTestPoints::random(4);
  for (std::size_t i = 0; i < 4; ++i) {
    // 64 bits throughout; a sum of at most 2000 terms below the amplitude.
    RC_ASSERT(std::abs(grid.calcValue(points.at(i), 0) - naive(grid, points.at(i))) <=
              4096 * 0x1p-53 * hb::amplitude(grid));
  }
}

// Regular sets of every level, at the same float coordinates.
TEST(hbSparseGrid, DirectAgreesWithTheReference) {
  const hbTestPoints points = hbTestPoints::random(500);
  std::vector<float> values(500);
  for (int n = 1; n <= 11; ++n) {
    const hbSparseGrid grid = gridOf("smooth", hbIndexSet::regular(n, {}));
    grid.values(points.view(), 0, values);
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_NEAR(values[i], grid.calcValue(points.at(i), 0), directBound(grid)) << "level " << n;
  }
}

RC_GTEST_PROP(hbSparseGrid, InterpolatesAtEveryNode, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto field = hbAnalyticField::create("smooth")->withSize(hbTestSets::sizeOf(set));
  const hbSparseGrid grid = hbSparseGrid::interpolate(*field, set, hbLatticeMapping::fitted);
  const auto node = [&](int d, int level, std::int64_t k) {
    if (set.flat()[d]) return 0.5;
    return level == 0 ? double(k) : std::ldexp(double(2 * k + 1), -level);
  };
  // Nodes are exact in floats and their weights dyadic: what remains is the rounding of surpluses (and of the field to
  // floats).
  const double tolerance = 2.0 * 0x1p-24 * hb::amplitude(grid);
  for (const hbSubspace& s : set.subspaces())
    for (std::int64_t k = 0; k < s.nodes.z; ++k)
      for (std::int64_t j = 0; j < s.nodes.y; ++j)
        for (std::int64_t i = 0; i < s.nodes.x; ++i) {
          const glm::dvec3 p(node(0, s.levels.x, i), node(1, s.levels.y, j), node(2, s.levels.z, k));
          RC_ASSERT(std::abs(grid.calcValue(p, 0) - field->value(p)) <= tolerance);
        }
}

RC_GTEST_PROP(hbSparseGrid, ReproducesMultilinearFunctions, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto field = hbAnalyticField::create("multilinear")->withSize(hbTestSets::sizeOf(set));
  const hbSparseGrid grid = hbSparseGrid::interpolate(*field, set, hbLatticeMapping::fitted);
  const hbTestPoints points = hbTestPoints::random(20);
  std::vector<float> values(20), truth(20);
  grid.values(points.view(), 0, values);
  field->values(points.view(), 0, truth);
  // The field is rounded to floats at the nodes (values up to 16, so 8 ulp of the surplus stencil) and here.
  const double tolerance = directBound(grid) + 10.0 * 16.0 * 0x1p-24;
  for (std::size_t i = 0; i < values.size(); ++i) RC_ASSERT(std::abs(values[i] - truth[i]) <= tolerance);
}

// Equation (8): the error of a smooth function falls as h^2 log2(1/h)^2, where h = 2^-n; so e(n) / (4^-n n^2) stays
// bounded. In three dimensions the leading constant is reached slowly: from level to level the ratio may not grow by
// more than a tenth, and over six levels it must not grow at all. A full grid's rate 4^-n would fail the second half:
// the log is really there.
TEST(hbSparseGrid, TheErrorOfASmoothFunctionFallsAsPublished) {
  const auto field = hbAnalyticField::create("smooth");
  const hbTestPoints points = hbTestPoints::random(20000);
  std::vector<double> scaled;
  for (int n = 3; n <= 9; ++n) {
    const hbSparseGrid grid = gridOf("smooth", hbIndexSet::regular(n, {}));
    double worst = 0.0;
    for (std::size_t i = 0; i < points.x.size(); ++i)
      worst = std::max(worst, std::abs(grid.calcValue(points.at(i), 0) - field->value(points.at(i))));
    scaled.push_back(worst * std::pow(4.0, n) / (n * n));
  }
  for (std::size_t i = 1; i < scaled.size(); ++i) EXPECT_LT(scaled[i], 1.1 * scaled[i - 1]);
  EXPECT_LT(scaled.back(), scaled.front());
  EXPECT_GT(scaled.back() * 81.0, 1.2 * scaled.front() * 9.0); // e(n) 4^n grows
}

// Inside a cell of the finest lattice the function is trilinear, so central differences along an axis are exact but for
// rounding: 64 bits, steps of 1/8 cell.
RC_GTEST_PROP(hbSparseGrid, GradientsAreThoseOfTheInterpolantInsideCells, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const hbSparseGrid grid = gridOf("vortex", set);
  const hbSize3 size = hbTestSets::sizeOf(set);
  glm::dvec3 p, h;
  for (int d = 0; d < 3; ++d) {
    const double cells = double(std::max<std::int64_t>(size[d] - 1, 1));
    p[d] = (double(*rc::gen::inRange<int>(0, int(cells))) + 0.25 + 0.125 * *rc::gen::inRange(0, 5)) / cells;
    h[d] = 0.125 / cells;
  }
  glm::dvec3 gradient;
  const double value = grid.calcValue(p, 0, gradient);
  RC_ASSERT(value == grid.calcValue(p, 0));
  for (int d = 0; d < 3; ++d) {
    glm::dvec3 step(0.0);
    step[d] = h[d];
    const double difference = (grid.calcValue(p + step, 0) - grid.calcValue(p - step, 0)) / (2.0 * h[d]);
    RC_ASSERT(std::abs(difference - gradient[d]) <= 4096 * 0x1p-53 * hb::amplitude(grid) / h[d]);
  }
  // The 32-bit ones, at the same point: the slopes are up to 2^l times larger than the weights.
  const std::array<float, 3> q{float(p.x), float(p.y), float(p.z)};
  float v, dx, dy, dz;
  grid.gradients({{&q[0], 1}, {&q[1], 1}, {&q[2], 1}}, 0, {&v, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
  grid.calcValue({q[0], q[1], q[2]}, 0, gradient);
  for (int d = 0; d < 3; ++d) {
    const double bound = directBound(grid) * std::exp2(std::max(set.finest()[d], 1)) * 2.0;
    RC_ASSERT(std::abs((d == 0 ? dx : d == 1 ? dy : dz) - gradient[d]) <= bound);
  }
}

TEST(hbSparseGrid, GradientsAtKinksAreOneSidedTowardsPlus) {
  // One axis, level 1: nodes 0, 1/2, 1 with values 0, 1, 0: slopes +2, then -2.
  const hbIndexSet set = hbIndexSet::full({{1, 0, 0}, {false, true, true}});
  const hbSparseGrid grid = hbSparseGrid::fromNodalValues({cubeOf({3, 1, 1}), {}, {}}, set, {{0.0, 0.0, 1.0}});
  const std::array<std::pair<double, double>, 5> expected{
      {{0.0, 2.0}, {0.25, 2.0}, {0.5, -2.0}, {0.75, -2.0}, {1.0, -2.0}}};
  for (const auto& [x, slope] : expected) {
    glm::dvec3 gradient;
    grid.calcValue({x, 0.3, 0.3}, 0, gradient);
    EXPECT_EQ(gradient, glm::dvec3(slope, 0.0, 0.0)) << x;
  }
}

RC_GTEST_PROP(hbSparseGrid, LatticesAreTheValuesAtTheirPoints, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const hbSparseGrid grid = gridOf("vortex", set);
  // Of any shape, as the order of the axes depends on it.
  std::vector<double> xs{0.0, 0.125, 0.3, 1.0}, ys{0.2, 0.5}, zs{0.0, 0.77, 1.0};
  std::vector<double>& longest = *std::array{&xs, &ys, &zs}[*rc::gen::inRange<std::size_t>(0, 3)];
  longest.clear();
  for (int i = 0; i < 100; ++i) longest.push_back(i / 99.0);
  const std::size_t strideY = xs.size() + 1, strideZ = strideY * ys.size() + 1; // with gaps, which stay untouched
  std::vector<float> out(strideZ * zs.size(), -99.0F);
  grid.lattice(xs, ys, zs, 0, out.data(), strideY, strideZ);
  const double tolerance = std::max({hb::latticeBound(grid, 0), hb::latticeBound(grid, 1), hb::latticeBound(grid, 2)});
  for (std::size_t k = 0; k < zs.size(); ++k)
    for (std::size_t j = 0; j < ys.size(); ++j) {
      for (std::size_t i = 0; i < xs.size(); ++i)
        RC_ASSERT(std::abs(out[i + strideY * j + strideZ * k] - grid.calcValue({xs[i], ys[j], zs[k]}, 0)) <= tolerance);
      RC_ASSERT(out[xs.size() + strideY * j + strideZ * k] == -99.0F);
    }
}

RC_GTEST_PROP(hbSparseGrid, RangesEncloseEveryValueOfTheBox, ()) {
  const hbSparseGrid grid =
      gridOf(*rc::gen::elementOf(std::vector<std::string>{"vortex", "ball", "kink"}), *hbTestSets::any());
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
  grid.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1});
  RC_ASSERT(grid.range(box, 0).contains(value));
}

// Volumes of any size, flat and two-node axes included: every sample comes back. 8-bit samples have surpluses that
// floats hold exactly unless continued values take part, which are halved up to n times: below 2^-24 of 8 * 255 times
// the subspaces.
RC_GTEST_PROP(hbSparseGrid, AFullAlignedSetHoldsEverySample, ()) {
  const auto axis = rc::gen::inRange(1, 14);
  const hbSize3 size{*axis, *axis, *axis};
  const auto samples = *rc::gen::container<std::vector<std::uint8_t>>(std::size_t(size.x * size.y * size.z),
                                                                      rc::gen::arbitrary<std::uint8_t>());
  const hbVolumeField field(hbVolume::fromSamples(cubeOf(size), samples));
  const hbSparseGrid grid =
      hbSparseGrid::interpolate(field, hbIndexSet::full(hbIndexSet::axesOf(size)), hbLatticeMapping::aligned);
  std::array<std::vector<double>, 3> at;
  for (int d = 0; d < 3; ++d)
    for (std::int64_t i = 0; i < size[d]; ++i)
      at[std::size_t(d)].push_back(size[d] == 1 ? 0.5 : double(i) / double(size[d] - 1));
  std::vector<float> out(samples.size());
  grid.lattice(at[0], at[1], at[2], 0, out.data(), std::size_t(size.x), std::size_t(size.x * size.y));
  for (std::size_t i = 0; i < out.size(); ++i) {
    RC_ASSERT(std::nearbyint(out[i]) == float(samples[i]));
    RC_ASSERT(std::abs(out[i] - float(samples[i])) <= 2.0 * 0x1p-24 * hb::amplitude(grid));
  }
}

TEST(hbSparseGrid, PowersOfTwoPlusOneMakeTheMappingsCoincide) {
  const auto field = hbAnalyticField::create("vortex,size=17x9x5");
  const hbIndexSet set = hbIndexSet::regular(4, hbIndexSet::axesOf({17, 9, 5}));
  const hbSparseGrid fitted = hbSparseGrid::interpolate(*field, set, hbLatticeMapping::fitted);
  const hbSparseGrid aligned = hbSparseGrid::interpolate(*field, set, hbLatticeMapping::aligned);
  ASSERT_EQ(fitted.surpluses(0).size(), aligned.surpluses(0).size());
  for (std::size_t i = 0; i < fitted.surpluses(0).size(); ++i)
    EXPECT_EQ(fitted.surpluses(0)[i], aligned.surpluses(0)[i]);
}

TEST(hbSparseGrid, CappedAxesLoseNothingOfAResolvedVolume) {
  // 17 x 9 x 5 samples: levels beyond 4, 3, 2 add surpluses of a trilinear field, which are zero up to rounding.
  std::vector<float> samples(17 * 9 * 5);
  std::mt19937 random(1);
  for (float& s : samples) s = float(random() % 1000U);
  const hbVolumeField field(hbVolume::fromSamples(cubeOf({17, 9, 5}), samples));
  const auto capped = hbIndexSet::regular(7, hbIndexSet::axesOf({17, 9, 5}));
  const auto uncapped = hbIndexSet::regular(7, hbIndexSet::uncappedAxesOf({17, 9, 5}));
  ASSERT_LT(capped.storedValues(), uncapped.storedValues());
  const hbSparseGrid a = hbSparseGrid::interpolate(field, capped, hbLatticeMapping::fitted);
  const hbSparseGrid b = hbSparseGrid::interpolate(field, uncapped, hbLatticeMapping::fitted);
  for (const glm::dvec3 p : {glm::dvec3(0.1, 0.9, 0.4), glm::dvec3(0.77, 0.33, 0.6)})
    EXPECT_NEAR(a.calcValue(p, 0), b.calcValue(p, 0), directBound(b));
}

TEST(hbSparseGrid, TwoComponentsAreTwoFields) {
  const hbSize3 size{9, 6, 5};
  std::vector<std::int16_t> a, b, both;
  for (int i = 0; i < 9 * 6 * 5; ++i) {
    a.push_back(std::int16_t(i * 7919 % 3001));
    b.push_back(std::int16_t(-i * 104729 % 2003));
    both.push_back(a.back());
    both.push_back(b.back());
  }
  const hbIndexSet set = hbIndexSet::regular(3, hbIndexSet::axesOf(size));
  const auto grid = [&](std::vector<std::int16_t> samples, int components) {
    return hbSparseGrid::interpolate(hbVolumeField(hbVolume::fromSamples(cubeOf(size), std::move(samples), components)),
                                     set, hbLatticeMapping::fitted);
  };
  const hbSparseGrid first = grid(a, 1), second = grid(b, 1), pair = grid(both, 2);
  ASSERT_EQ(pair.components(), 2);
  EXPECT_TRUE(std::equal(pair.surpluses(0).begin(), pair.surpluses(0).end(), first.surpluses(0).begin()));
  EXPECT_TRUE(std::equal(pair.surpluses(1).begin(), pair.surpluses(1).end(), second.surpluses(0).begin()));
  EXPECT_EQ(pair.calcValue({0.3, 0.3, 0.3}, 1), second.calcValue({0.3, 0.3, 0.3}, 0));
}

TEST(hbSparseGrid, TheSameSurplusesForAnyNumberOfThreads) {
  std::vector<float> first;
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const hbSparseGrid grid = gridOf("vortex", hbIndexSet::regular(7, {}));
    const std::vector<float> surpluses(grid.surpluses(0).begin(), grid.surpluses(0).end());
    if (first.empty()) first = surpluses;
    EXPECT_EQ(surpluses, first) << threads;
  }
}

RC_GTEST_PROP(hbSparseGrid, ComponentGridsOfAnInterpolantGiveItBack, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto field = hbAnalyticField::create("vortex")->withSize(hbTestSets::sizeOf(set));
  const hbSparseGrid grid = hbSparseGrid::interpolate(*field, set, hbLatticeMapping::fitted);
  std::vector<hbSparseGrid::ComponentValues> parts;
  for (const auto& component : set.componentGrids()) {
    hbSparseGrid::ComponentValues part{component.levels, {}};
    const auto at = [&](int d, std::int64_t i) {
      return component.nodes[d] == 1 ? 0.5 : double(i) / double(component.nodes[d] - 1);
    };
    for (std::int64_t k = 0; k < component.nodes.z; ++k)
      for (std::int64_t j = 0; j < component.nodes.y; ++j)
        for (std::int64_t i = 0; i < component.nodes.x; ++i)
          part.values.push_back(field->value({at(0, i), at(1, j), at(2, k)}));
    parts.push_back(std::move(part));
  }
  const hbSparseGrid again = hbSparseGrid::fromComponentGrids(grid.frame(), set, {parts});
  // Sampled in 64 bits here and in floats there; coefficients sum to 1 with magnitudes that double rounding does not
  // see.
  for (const glm::dvec3 p : {glm::dvec3(0.1, 0.9, 0.4), glm::dvec3(0.77, 0.33, 0.6)})
    RC_ASSERT(std::abs(again.calcValue(p, 0) - grid.calcValue(p, 0)) <= directBound(grid) + 1e-6);
  parts.erase(parts.begin());
  RC_ASSERT_THROWS_AS(hbSparseGrid::fromComponentGrids(grid.frame(), set, {parts}), hbError);
}

TEST(hbSparseGrid, NodalValuesComeBack) {
  const hbIndexSet set = hbIndexSet::regular(4, {});
  std::vector<double> nodal(std::size_t(set.storedValues()));
  for (std::size_t i = 0; i < nodal.size(); ++i) nodal[i] = double(i * 40503U % 256U);
  const hbGeometry geometry = cubeOf({17, 17, 17});
  const hbSparseGrid grid = hbSparseGrid::fromNodalValues({geometry, {}, {}}, set, {nodal});
  EXPECT_EQ(grid.nodalValues(0), nodal);
  EXPECT_THROW(hbSparseGrid::fromNodalValues({geometry, {}, {}}, set, {{1.0, 2.0}}), hbError);
  EXPECT_THROW(hbSparseGrid::fromNodalValues({geometry, {}, {}}, set, {}), hbError);
  nodal[5] = std::nan("");
  EXPECT_THROW(hbSparseGrid::fromNodalValues({geometry, {}, {}}, set, {nodal}), hbError);
  EXPECT_THROW(hbSparseGrid::fromSurpluses({geometry, {}, {}}, set, {std::vector<float>(nodal.begin(), nodal.end())}),
               hbError);
  // A volume with a flat axis and an index set without one do not fit.
  EXPECT_THROW(hbSparseGrid::fromSurpluses({cubeOf({17, 17, 1}), {}, {}}, set, {std::vector<float>(nodal.size())}),
               hbError);
}
