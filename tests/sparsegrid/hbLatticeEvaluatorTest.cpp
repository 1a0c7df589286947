#include "sparsegrid/hbLatticeEvaluator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbInstructionSet.h"

namespace {

using Quantity = hbLatticeEvaluator::Quantity;

constexpr std::array<hbAxisOrder, 6> kOrders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

/// Places along an axis: some nodes of one level beside each other, every second of them, or anything; all of the cube
/// or a box.
rc::Gen<std::vector<double>> places() {
  return rc::gen::exec([] {
    const int cells = 1 << *rc::gen::inRange(0, 9);
    const int first = *rc::gen::inRange(0, cells + 1), step = *rc::gen::inRange(1, 3);
    const int most = *rc::gen::inRange(1, 40);
    std::vector<double> list;
    for (int i = first; i <= cells && int(list.size()) < most; i += step) list.push_back(double(i) / cells);
    if (*rc::gen::inRange(0, 2) == 0)
      for (double& place : list) place += 0.3 * (1.0 - place) / cells;
    return list;
  });
}

/// Two components of a small set, or of a regular one so fine along some axes that the row axis has coarse and fine
/// levels.
hbSparseGrid anyGrid() {
  hbIndexSet set = *hbTestSets::any();
  if (*rc::gen::inRange(0, 2) == 0) {
    hbIndexSet::Axes axes;
    for (int d = 0; d < 3; ++d) axes.maxLevel[d] = *rc::gen::inRange(1, 10);
    set = hbIndexSet::regular(*rc::gen::inRange(6, 10), axes);
  }
  hbSize3 size = hbTestSets::sizeOf(set);
  const auto mapping = *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned);
  for (int d = 0; d < 3; ++d)
    if (mapping == hbLatticeMapping::aligned && set.finest()[d] > 1) --size[d];
  std::vector<std::vector<float>> surpluses;
  std::optional<hbSparseGrid> grid;
  for (const char* field : {"vortex", "kink"}) {
    grid = hbSparseGrid::interpolate(*hbAnalyticField::create(field)->withSize(size), set, mapping);
    const auto values = grid->surpluses(0);
    surpluses.emplace_back(values.begin(), values.end());
  }
  return hbSparseGrid::fromSurpluses(grid->frame(), set, surpluses);
}

/// The reference: one point after the other.
double exact(const hbSparseGrid& grid, int component, const hbAxisOrder& order, Quantity quantity, double u, double v,
             double w) {
  glm::dvec3 point{0.0}, gradient{0.0};
  point[order.fast] = u;
  point[order.row] = v;
  point[order.plane] = w;
  const double value = grid.calcValue(point, component, gradient);
  const int axes[] = {0, order.fast, order.row, order.plane};
  return quantity == Quantity::value ? value : gradient[axes[int(quantity)]];
}

} // namespace

RC_GTEST_PROP(hbLatticeEvaluator, GivesTheValuesAtTheirPoints, ()) {
  const hbSparseGrid grid = anyGrid();
  const hbAxisOrder order = *rc::gen::elementOf(kOrders);
  const int component = *rc::gen::inRange(0, 2);
  const std::vector<double> us = *places(), vs = *places(), ws = *places();
  const hbLatticeEvaluator evaluator(grid, component, order);
  const hbLatticePlan plan = evaluator.plan(us, vs);
  hbLatticeWorkspace workspace;
  const std::size_t stride = us.size() + 2; // with gaps, which stay untouched
  const double tolerance = hb::latticeBound(grid, order.row, component);
  for (const double w : ws)
    for (const bool pastCaches : {false, true}) {
      std::vector<float> out(stride * vs.size(), -99.0F);
      evaluator.plane(plan, w, workspace, out.data(), stride, pastCaches);
      for (std::size_t j = 0; j < vs.size(); ++j) {
        for (std::size_t i = 0; i < us.size(); ++i)
          RC_ASSERT(std::abs(out[i + stride * j] - exact(grid, component, order, Quantity::value, us[i], vs[j], w)) <=
                    tolerance);
        RC_ASSERT(out[us.size() + stride * j] == -99.0F);
      }
    }
}

RC_GTEST_PROP(hbLatticeEvaluator, GivesValuesAndSlopesIn64Bits, ()) {
  const hbSparseGrid grid = anyGrid();
  const hbAxisOrder order = *rc::gen::elementOf(kOrders);
  const int component = *rc::gen::inRange(0, 2);
  const std::vector<double> us = *places(), vs = *places(), ws = *places();
  const hbLatticeEvaluator evaluator(grid, component, order);
  hbLatticeWorkspace64 workspace;
  std::vector<double> out(us.size() * vs.size());
  for (const Quantity quantity : {Quantity::value, Quantity::slopeFast, Quantity::slopeRow, Quantity::slopePlane}) {
    const hbLatticePlan64 plan = evaluator.planOf<double>(us, vs, quantity);
    // A slope multiplies by at most 2^finest.
    const double steepest =
        quantity == Quantity::value
            ? 1.0
            : std::exp2(std::max({grid.indexSet().finest().x, grid.indexSet().finest().y, grid.indexSet().finest().z}));
    const double tolerance = 4096 * 0x1p-53 * steepest * hb::amplitude(grid, component);
    for (const double w : ws) {
      evaluator.plane(plan, w, workspace, out.data(), us.size());
      for (std::size_t j = 0; j < vs.size(); ++j)
        for (std::size_t i = 0; i < us.size(); ++i)
          RC_ASSERT(std::abs(out[i + us.size() * j] - exact(grid, component, order, quantity, us[i], vs[j], w)) <=
                    tolerance);
    }
  }
}

RC_GTEST_PROP(hbLatticeEvaluator, GivesSlopesIn32Bits, ()) {
  const hbSparseGrid grid = anyGrid();
  const hbAxisOrder order = *rc::gen::elementOf(kOrders);
  const int component = *rc::gen::inRange(0, 2);
  const std::vector<double> us = *places(), vs = *places();
  const double w = *rc::gen::inRange(0, 101) / 100.0;
  const hbLatticeEvaluator evaluator(grid, component, order);
  hbLatticeWorkspace workspace;
  std::vector<float> out(us.size() * vs.size());
  for (const Quantity quantity : {Quantity::slopeFast, Quantity::slopeRow, Quantity::slopePlane}) {
    evaluator.plane(evaluator.plan(us, vs, quantity), w, workspace, out.data(), us.size());
    const double steepest =
        std::exp2(std::max({grid.indexSet().finest().x, grid.indexSet().finest().y, grid.indexSet().finest().z}));
    const double tolerance = steepest * hb::latticeBound(grid, order.row, component);
    for (std::size_t j = 0; j < vs.size(); ++j)
      for (std::size_t i = 0; i < us.size(); ++i)
        RC_ASSERT(std::abs(out[i + us.size() * j] - exact(grid, component, order, quantity, us[i], vs[j], w)) <=
                  tolerance);
  }
}

// What a box or a level of detail of all samples gives are the very bits that the whole gives there.
RC_GTEST_PROP(hbLatticeEvaluator, PartsOfALatticeHaveTheBitsOfTheWhole, ()) {
  const hbSparseGrid grid = anyGrid();
  const hbLatticeEvaluator evaluator(grid, 0);
  std::array<std::vector<double>, 2> whole, some;
  std::array<std::vector<std::size_t>, 2> places;
  for (std::size_t d = 0; d < 2; ++d) {
    whole[d] = grid.geometry().cubeCoordinates(int(d));
    const std::size_t first = *rc::gen::inRange<std::size_t>(0, whole[d].size());
    const std::size_t end = *rc::gen::inRange<std::size_t>(first + 1, whole[d].size() + 1);
    const std::size_t step = std::size_t(1) << *rc::gen::inRange(0, 3);
    // Nodes that are two or more apart are adjacent ones of a coarser level.
    for (std::size_t i = first / step * step; i < end; i += step) {
      places[d].push_back(i);
      some[d].push_back(whole[d][i]);
    }
  }
  const double z = *rc::gen::inRange(0, 101) / 100.0;
  hbLatticeWorkspace workspace;
  std::vector<float> all(whole[0].size() * whole[1].size()), part(some[0].size() * some[1].size());
  evaluator.plane(evaluator.plan(whole[0], whole[1]), z, workspace, all.data(), whole[0].size());
  evaluator.plane(evaluator.plan(some[0], some[1]), z, workspace, part.data(), some[0].size());
  for (std::size_t j = 0; j < places[1].size(); ++j)
    for (std::size_t i = 0; i < places[0].size(); ++i)
      RC_ASSERT(part[i + places[0].size() * j] == all[places[0][i] + whole[0].size() * places[1][j]]);
}

TEST(hbLatticeEvaluator, GivesTheSameWithEveryInstructionSet) {
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("vortex,size=513"),
                                                      hbIndexSet::regular(9, {}), hbLatticeMapping::fitted);
  std::vector<double> nodes, between;
  for (int i = 0; i <= 64; ++i) nodes.push_back(i / 64.0);
  for (int i = 0; i < 37; ++i) between.push_back(i / 37.0);
  for (const std::vector<double>& us : {nodes, between})
    for (const Quantity quantity : {Quantity::value, Quantity::slopeFast, Quantity::slopeRow}) {
      std::vector<float> first;
      std::vector<double> first64;
      for (const std::string& name : hb::instructionSets()) {
        hb::useInstructionSet(name);
        std::vector<float> out(us.size() * between.size());
        std::vector<double> out64(out.size());
        const hbLatticeEvaluator evaluator(grid, 0);
        hbLatticeWorkspace workspace;
        hbLatticeWorkspace64 workspace64;
        evaluator.plane(evaluator.plan(us, between, quantity), 0.3, workspace, out.data(), us.size());
        evaluator.plane(evaluator.planOf<double>(us, between, quantity), 0.3, workspace64, out64.data(), us.size());
        if (first.empty()) {
          first = out;
          first64 = out64;
        }
        EXPECT_EQ(out, first) << name;
        EXPECT_EQ(out64, first64) << name;
      }
      hb::useInstructionSet("");
    }
}

TEST(hbLatticeEvaluator, NoPlacesAndPlacesOutside) {
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("smooth,size=9"),
                                                      hbIndexSet::regular(3, {}), hbLatticeMapping::fitted);
  const hbLatticeEvaluator evaluator(grid, 0);
  hbLatticeWorkspace workspace;
  evaluator.plane(evaluator.plan({}, {}), 0.5, workspace, static_cast<float*>(nullptr), 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> us{-1.0, nan, 2.0}, vs{nan};
  std::vector<float> out(3);
  evaluator.plane(evaluator.plan(us, vs), 7.0, workspace, out.data(), 3);
  // At corners the value is a stored one.
  EXPECT_EQ(out[0], float(grid.calcValue({0, 0, 1}, 0)));
  EXPECT_EQ(out[1], float(grid.calcValue({0, 0, 1}, 0)));
  EXPECT_EQ(out[2], float(grid.calcValue({1, 0, 1}, 0)));
}
