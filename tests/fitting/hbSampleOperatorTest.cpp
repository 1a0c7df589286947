#include "fitting/hbSampleOperator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbSparseGrid.h"
#include "tests/sparsegrid/hbTestSets.h"

namespace {

/// A set and the coordinates of some samples: any number an axis (one of a flat one), nodes and places between them.
struct Case {
  hbIndexSet set;
  std::array<std::vector<double>, 3> places;

  hbSampleOperator made() const { return {set, {places[0], places[1], places[2]}}; }
  std::size_t samples() const { return places[0].size() * places[1].size() * places[2].size(); }
  std::size_t ofPlane() const { return places[0].size() * places[1].size(); }
};

Case anyCase() {
  Case c{*hbTestSets::any(), {}};
  for (int d = 0; d < 3; ++d) {
    auto& axis = c.places[std::size_t(d)];
    const int count = c.set.flat()[d] ? 1 : *rc::gen::inRange(1, 12);
    const double last = count == 1 ? 1.0 : double(count - 1) / *rc::gen::element(1.0, 0.7);
    for (int i = 0; i < count; ++i) axis.push_back(double(i) / last);
  }
  return c;
}

/// Small integers and their eighths.
std::vector<double> numbers(std::size_t count) {
  const std::vector<int> some = *rc::gen::container<std::vector<int>>(count, rc::gen::inRange(-64, 65));
  std::vector<double> list(some.begin(), some.end());
  for (double& x : list) x /= 8.0;
  return list;
}

std::vector<double> valuesOf(const Case& c, const std::vector<double>& surpluses) {
  std::vector<double> values(c.samples());
  c.made().apply(surpluses, [&](std::int64_t z, std::span<double> plane) {
    std::copy(plane.begin(), plane.end(), values.begin() + std::ptrdiff_t(std::size_t(z) * c.ofPlane()));
  });
  return values;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

} // namespace

// Surpluses of up to 8 are exact floats. A value is a sum of a product of three weights for each of the subspaces (up
// to 6^3, 8 at level 0), in any order: below 220 roundings of terms whose magnitudes sum to at most 8 times the
// subspaces.
RC_GTEST_PROP(hbSampleOperator, GivesTheValuesOfTheSparseGrid, ()) {
  const Case c = anyCase();
  const std::vector<double> surpluses = numbers(std::size_t(c.set.storedValues()));
  hbGeometry geometry;
  geometry.size = hbTestSets::sizeOf(c.set);
  const hbSparseGrid grid =
      hbSparseGrid::fromSurpluses({geometry, {}, {}}, c.set, {std::vector<float>(surpluses.begin(), surpluses.end())});
  const std::vector<double> values = valuesOf(c, surpluses);
  const double tolerance = 220.0 * 0x1p-53 * 8.0 * double(c.set.subspaces().size());
  std::size_t at = 0;
  for (const double z : c.places[2])
    for (const double y : c.places[1])
      for (const double x : c.places[0]) RC_ASSERT(std::abs(values[at++] - grid.calcValue({x, y, z}, 0)) <= tolerance);
}

// <A s, v> = <s, A'v>. Both are sums over samples and subspaces of surplus * weights * v, each at most 64, of which a
// sample has one a subspace (two an axis at level 0, with weights that sum to 1).
RC_GTEST_PROP(hbSampleOperator, TheTransposeIsTheAdjoint, ()) {
  const Case c = anyCase();
  const std::vector<double> s = numbers(std::size_t(c.set.storedValues())), v = numbers(c.samples());
  std::vector<double> transposed(s.size());
  c.made().applyTransposed(
      [&](std::int64_t z, std::span<double> plane) {
        std::copy_n(v.begin() + std::ptrdiff_t(std::size_t(z) * c.ofPlane()), plane.size(), plane.begin());
      },
      transposed);
  const double terms = double(c.samples()) * double(c.set.subspaces().size());
  RC_ASSERT(std::abs(dot(valuesOf(c, s), v) - dot(s, transposed)) <= (220.0 + terms) * 0x1p-53 * 64.0 * terms);
}

// Squares are not negative, and only the weights of a plane's work enter: the same as both ways one after the other.
RC_GTEST_PROP(hbSampleOperator, BothWaysAtOnceAreOneAfterTheOther, ()) {
  const Case c = anyCase();
  const std::vector<double> s = numbers(std::size_t(c.set.storedValues()));
  const auto weigh = [](std::int64_t z, std::span<double> plane) {
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] *= double((i + std::size_t(z)) % 3);
  };
  std::vector<double> both = s, values = valuesOf(c, s), after(s.size());
  c.made().applyBoth(both, weigh, both);
  c.made().applyTransposed(
      [&](std::int64_t z, std::span<double> plane) {
        std::copy_n(values.begin() + std::ptrdiff_t(std::size_t(z) * c.ofPlane()), plane.size(), plane.begin());
        weigh(z, plane);
      },
      after);
  RC_ASSERT(both == after);
}

TEST(hbSampleOperator, DoesNotDependOnTheNumberOfThreads) {
  Case c{hbIndexSet::regular(6, hbIndexSet::axesOf({33, 33, 33})), {}};
  for (auto& axis : c.places)
    for (int i = 0; i < 40; ++i) axis.push_back(i / 39.0);
  std::vector<double> one(std::size_t(c.set.storedValues()));
  for (std::size_t i = 0; i < one.size(); ++i) one[i] = std::sin(double(i));
  std::vector<double> two = one;
  const auto half = [](std::int64_t, std::span<double> plane) {
    for (double& v : plane) v *= 0.3;
  };
  {
    const oneapi::tbb::global_control single(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    c.made().applyBoth(one, half, one);
  }
  c.made().applyBoth(two, half, two);
  EXPECT_EQ(one, two);
}

TEST(hbSampleOperator, StopsWhenCancelled) {
  Case c{hbIndexSet::regular(3, hbIndexSet::axesOf({9, 9, 9})), {}};
  for (auto& axis : c.places) axis = {0.0, 0.25, 1.0};
  std::vector<double> surpluses(std::size_t(c.set.storedValues()), 1.0);
  hbProgress progress;
  progress.cancel();
  bool called = false;
  c.made().applyBoth(
      surpluses, [&](std::int64_t, std::span<double>) { called = true; }, surpluses, progress);
  EXPECT_FALSE(called);
}
