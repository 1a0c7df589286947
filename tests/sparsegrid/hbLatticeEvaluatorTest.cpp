#include "sparsegrid/hbLatticeEvaluator.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbInstructionSet.h"

namespace {

/// Places along an axis: some nodes of one level beside each other, every second of them, or anything.
rc::Gen<std::vector<double>> places() {
  return rc::gen::exec([] {
    const int cells = 1 << *rc::gen::inRange(0, 7);
    const int first = *rc::gen::inRange(0, cells + 1), step = *rc::gen::inRange(1, 3);
    std::vector<double> list;
    for (int i = first; i <= cells; i += step) list.push_back(double(i) / cells);
    if (*rc::gen::inRange(0, 3) == 0) list.back() += 0.3 * (1.0 - list.back());
    return list;
  });
}

} // namespace

RC_GTEST_PROP(hbLatticeEvaluator, GivesTheValuesAtTheirPoints, ()) {
  const hbIndexSet set = *hbTestSets::any();
  hbSize3 size = hbTestSets::sizeOf(set);
  const auto mapping = *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned);
  for (int d = 0; d < 3; ++d)
    if (mapping == hbLatticeMapping::aligned && set.finest()[d] > 1) --size[d];
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(size), set, mapping);
  const std::vector<double> xs = *places(), ys = *places(), zs = *places();
  const hbLatticeEvaluator evaluator(grid, 0, xs, ys);
  const std::size_t stride = xs.size() + 2;                                          // with gaps, which stay untouched
  const double tolerance = (0x1p-24 + 4096 * 0x1p-53) * hbTestSets::amplitude(grid); // rounded once
  for (const double z : zs) {
    std::vector<float> out(stride * ys.size(), -99.0F);
    evaluator.plane(z, out.data(), stride);
    for (std::size_t j = 0; j < ys.size(); ++j) {
      for (std::size_t i = 0; i < xs.size(); ++i)
        RC_ASSERT(std::abs(out[i + stride * j] - grid.calcValue({xs[i], ys[j], z}, 0)) <= tolerance);
      RC_ASSERT(out[xs.size() + stride * j] == -99.0F);
    }
  }
}

TEST(hbLatticeEvaluator, GivesTheSameWithEveryInstructionSet) {
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("vortex,size=129"),
                                                      hbIndexSet::regular(7, {}), hbLatticeMapping::fitted);
  std::vector<double> nodes, between;
  for (int i = 0; i <= 64; ++i) nodes.push_back(i / 64.0);
  for (int i = 0; i < 37; ++i) between.push_back(i / 37.0);
  for (const std::vector<double>& xs : {nodes, between}) {
    std::vector<float> first;
    for (const std::string& name : hb::instructionSets()) {
      hb::useInstructionSet(name);
      std::vector<float> out(xs.size() * between.size());
      hbLatticeEvaluator(grid, 0, xs, between).plane(0.3, out.data(), xs.size());
      if (first.empty()) first = out;
      EXPECT_EQ(out, first) << name;
    }
    hb::useInstructionSet("");
  }
}

TEST(hbLatticeEvaluator, NoPlacesAndPlacesOutside) {
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("smooth,size=9"),
                                                      hbIndexSet::regular(3, {}), hbLatticeMapping::fitted);
  hbLatticeEvaluator(grid, 0, {}, {}).plane(0.5, nullptr, 0);
  const std::vector<double> xs{-1.0, 2.0}, ys{std::numeric_limits<double>::quiet_NaN()};
  std::vector<float> out(2);
  hbLatticeEvaluator(grid, 0, xs, ys).plane(7.0, out.data(), 2);
  // At corners the value is a stored one.
  EXPECT_EQ(out[0], float(grid.calcValue({0, 0, 1}, 0)));
  EXPECT_EQ(out[1], float(grid.calcValue({1, 0, 1}, 0)));
}
