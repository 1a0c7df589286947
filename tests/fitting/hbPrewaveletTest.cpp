#include "fitting/hbPrewavelet.h"

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbHat.h"
#include "tests/sparsegrid/hbTestSets.h"

namespace {

/// The integral over [0,1] of the product of two functions that are linear between multiples of 2^-level: exact by
/// Simpson's rule.
template <class F, class G>
double product(F f, G g, int level) {
  const int cells = 1 << level;
  double sum = 0.0;
  for (int i = 0; i < cells; ++i) {
    const double a = double(i) / cells, b = double(i + 1) / cells, m = 0.5 * (a + b);
    sum += (f(a) * g(a) + 4.0 * f(m) * g(m) + f(b) * g(b)) / (6.0 * cells);
  }
  return sum;
}

} // namespace

// Values of at most 1.2 at multiples of 2^-6: a sum of 64 products rounds below 64 * 2^-53 * 1.44.
TEST(hbPrewavelet, IsOrthogonalToAllCoarserOnes) {
  constexpr int kLevels = 6;
  for (int fine = 1; fine <= kLevels; ++fine)
    for (std::int64_t k = 0; k < hbIndexSet::axisNodes(false, fine); ++k)
      for (int coarse = 0; coarse < fine; ++coarse)
        for (std::int64_t j = 0; j < hbIndexSet::axisNodes(false, coarse); ++j) {
          const hbPrewavelet a = hbPrewavelet::at(false, fine, k), b = hbPrewavelet::at(false, coarse, j);
          EXPECT_NEAR(product([&](double x) { return a.value(x); }, [&](double x) { return b.value(x); }, fine), 0.0,
                      64.0 * 0x1p-53 * 1.44);
        }
}

TEST(hbPrewavelet, OfAFlatAxisIsOne) {
  EXPECT_EQ(hbPrewavelet::at(true, 0, 0).value(0.0), 1.0);
  EXPECT_EQ(hbPrewavelet::at(true, 0, 0).value(0.75), 1.0);
}

// One prewavelet's surpluses, evaluated, are its values: dyadic coordinates, and values of tenths times powers of two,
// of which up to 7^3 are added.
RC_GTEST_PROP(hbPrewavelet, SurplusesAreThoseOfTheSameFunction, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto& subspaces = set.subspaces();
  const hbSubspace& own = subspaces[std::size_t(*rc::gen::inRange(0, int(subspaces.size())))];
  const glm::i64vec3 node(*rc::gen::inRange<std::int64_t>(0, own.nodes.x),
                          *rc::gen::inRange<std::int64_t>(0, own.nodes.y),
                          *rc::gen::inRange<std::int64_t>(0, own.nodes.z));
  std::vector<double> surpluses(std::size_t(set.storedValues()));
  surpluses[std::size_t(own.offset + node.x + own.nodes.x * (node.y + own.nodes.y * node.z))] = 1.0;
  hb::prewaveletsToSurpluses(set, surpluses);
  for (int trial = 0; trial < 20; ++trial) {
    double expected = 1.0, found = 0.0;
    std::array<hbHat<double>, 3> hats;
    for (int d = 0; d < 3; ++d) {
      const double x = double(*rc::gen::inRange(0, 129)) / 128.0;
      expected *= hbPrewavelet::at(set.flat()[d], own.levels[d], node[d]).value(x);
      hats[std::size_t(d)].evaluate(x, set.flat()[d], set.finest()[d]);
    }
    for (const hbSubspace& s : subspaces)
      for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        glm::i64vec3 at(0);
        for (int d = 0; d < 3; ++d) {
          const bool second = (corner >> d & 1) != 0;
          const hbHat<double>& hat = hats[std::size_t(d)];
          if (second && s.levels[d] > 0) weight = 0.0;
          const auto slot = std::size_t(s.levels[d] > 0 ? s.levels[d] + 1 : second ? 1 : 0);
          if (second && set.flat()[d]) {
            weight = 0.0;
            continue;
          }
          weight *= hat.weight[slot];
          at[d] = hat.node[slot];
        }
        if (weight != 0.0)
          found += weight * surpluses[std::size_t(s.offset + at.x + s.nodes.x * (at.y + s.nodes.y * at.z))];
      }
    RC_ASSERT(std::abs(found - expected) <= 343.0 * 0x1p-53 * 8.0);
  }
}

// <T c, s> = <c, T's>: sums of up to 10^5 terms below 8 * 8 * 1.2^3.
RC_GTEST_PROP(hbPrewavelet, TheTransposeIsTheAdjoint, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto count = std::size_t(set.storedValues());
  const auto numbers = [&] {
    const auto some = *rc::gen::container<std::vector<int>>(count, rc::gen::inRange(-8, 9));
    return std::vector<double>(some.begin(), some.end());
  };
  const std::vector<double> c = numbers(), s = numbers();
  std::vector<double> forward = c, backward = s;
  hb::prewaveletsToSurpluses(set, forward);
  hb::prewaveletsToSurplusesTransposed(set, backward);
  const double left = std::inner_product(forward.begin(), forward.end(), s.begin(), 0.0);
  const double right = std::inner_product(c.begin(), c.end(), backward.begin(), 0.0);
  RC_ASSERT(std::abs(left - right) <= double(count) * 0x1p-53 * 64.0 * 1.728 * double(count));
}
