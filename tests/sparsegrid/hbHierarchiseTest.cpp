#include "sparsegrid/hbHierarchise.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"

namespace {

double f(double x, double y, double z) {
  return std::sin(2.0 * x + 0.3) * std::cos(1.5 * y - 0.2) * std::exp(0.7 * z) + x * y;
}

double nodeAt(bool flat, int level, std::int64_t k) {
  if (flat) return 0.5;
  return level == 0 ? double(k) : std::ldexp(double(2 * k + 1), -level);
}

/// Calls visit(subspace, place in the whole array, x, y, z) for each node.
template <class Visit>
void forEachNode(const hbIndexSet& set, Visit visit) {
  for (const hbSubspace& s : set.subspaces())
    for (std::int64_t k = 0, at = s.offset; k < s.nodes.z; ++k)
      for (std::int64_t j = 0; j < s.nodes.y; ++j)
        for (std::int64_t i = 0; i < s.nodes.x; ++i, ++at)
          visit(s, std::size_t(at), nodeAt(set.flat().x, s.levels.x, i), nodeAt(set.flat().y, s.levels.y, j),
                nodeAt(set.flat().z, s.levels.z, k));
}

std::vector<double> nodalValues(const hbIndexSet& set) {
  std::vector<double> values(std::size_t(set.storedValues()));
  forEachNode(set, [&](const hbSubspace&, std::size_t at, double x, double y, double z) { values[at] = f(x, y, z); });
  return values;
}

} // namespace

// Node by node from the function itself: the tensor product of the stencils [-1/2, 1, -1/2]. At most 27 terms of
// size 1.7 with weights that sum to 8: both sides round below 64 * 2^-53 * 8 * 2.
RC_GTEST_PROP(hbHierarchise, SurplusesAreTheTensorStencilOfTheFunction, ()) {
  const hbIndexSet set = *hbTestSets::any();
  std::vector<double> values = nodalValues(set);
  hb::hierarchise(set, values);
  constexpr double kTolerance = 64.0 * 0x1p-53 * 8.0 * 2.0;
  forEachNode(set, [&](const hbSubspace& s, std::size_t at, double x, double y, double z) {
    const auto axis = [&](int d, double u) {
      const double h = std::ldexp(1.0, -s.levels[d]);
      using Terms = std::vector<std::pair<double, double>>;
      return s.levels[d] == 0 ? Terms{{u, 1.0}} : Terms{{u - h, -0.5}, {u, 1.0}, {u + h, -0.5}};
    };
    double surplus = 0.0;
    for (const auto& [px, wx] : axis(0, x))
      for (const auto& [py, wy] : axis(1, y))
        for (const auto& [pz, wz] : axis(2, z)) surplus += wx * wy * wz * f(px, py, pz);
    RC_ASSERT(std::abs(values[at] - surplus) <= kTolerance);
  });
}

// Back and forth: a value is restored from the same neighbours that were taken away, in three axes: each step rounds
// once by at most 2^-53 of values up to 8 times the function's.
RC_GTEST_PROP(hbHierarchise, DehierarchiseIsTheInverse, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const std::vector<double> nodal = nodalValues(set);
  std::vector<double> values = nodal;
  hb::hierarchise(set, values);
  hb::dehierarchise(set, values);
  // Errors of the neighbours come in with weight 1/2 each, so they add up along the levels at most.
  const double tolerance = 6.0 * (3 + set.finest().x + set.finest().y + set.finest().z) * 0x1p-53 * 8.0 * 2.0;
  for (std::size_t i = 0; i < nodal.size(); ++i) RC_ASSERT(std::abs(values[i] - nodal[i]) <= tolerance);
}

TEST(hbHierarchise, IntegersComeBackExactly) {
  // 16-bit integers have surpluses that are multiples of 1/8 below 2^19: 64 bits hold them exactly.
  const hbIndexSet set = hbIndexSet::regular(7, {});
  std::vector<double> nodal(std::size_t(set.storedValues()));
  for (std::size_t i = 0; i < nodal.size(); ++i) nodal[i] = double(i * 40503U % 65536U);
  std::vector<double> values = nodal;
  hb::hierarchise(set, values);
  hb::dehierarchise(set, values);
  EXPECT_EQ(values, nodal);
}
