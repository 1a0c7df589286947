#include "glcombine/hbTermOrder.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"

namespace {

std::vector<double> coefficientsOf(const hbIndexSet& set) {
  std::vector<double> coefficients;
  for (const auto& grid : set.componentGrids()) coefficients.push_back(grid.coefficient);
  return coefficients;
}

} // namespace

TEST(hbTermOrder, PositiveAndNegativeTermsTakeTurns) {
  EXPECT_EQ(hb::interleaved(std::vector{1.0, 1.0, 1.0, -1.0, -1.0}), (std::vector<std::size_t>{0, 3, 1, 4, 2}));
  EXPECT_EQ(hb::interleaved(std::vector{-2.0, 1.0, 1.0, 1.0}), (std::vector<std::size_t>{1, 0, 2, 3}));
  EXPECT_EQ(hb::interleaved(std::vector{7.0}), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(hb::interleaved({}).empty());
}

// The paper's sets: all positive terms first would come to n(n+1)/2 + n(n-1)/2.
TEST(hbTermOrder, PartialSumsOfRegularSetsStayWithinTwo) {
  for (int n = 1; n <= 12; ++n) {
    const std::vector<double> coefficients = coefficientsOf(hbIndexSet::regular(n, {}));
    double sum = 0.0, least = 0.0, greatest = 0.0;
    for (const std::size_t i : hb::interleaved(coefficients)) {
      sum += coefficients[i];
      least = std::min(least, sum);
      greatest = std::max(greatest, sum);
    }
    EXPECT_EQ(sum, 1) << n;
    EXPECT_GE(least, -1) << n;
    EXPECT_LE(greatest, 2) << n;
  }
}

TEST(hbTermOrder, PartialSumsComeNearTheWholeWhateverItIs) {
  EXPECT_EQ(hb::interleaved(std::vector{-0.5, 0.25, -1.5, 1.0}), (std::vector<std::size_t>{0, 1, 3, 2}));
  EXPECT_EQ(hb::interleaved(std::vector{2.0, -1.0, 2.0}), (std::vector<std::size_t>{0, 1, 2}));
}

RC_GTEST_PROP(hbTermOrder, HasEachTermOnceAndKeepsPartialSumsSmall, ()) {
  const std::vector<double> coefficients = coefficientsOf(*hbTestSets::any());
  const std::vector<std::size_t> order = hb::interleaved(coefficients);
  std::vector<std::size_t> sorted = order, all(coefficients.size());
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), std::size_t{0});
  RC_ASSERT(sorted == all);
  double most = 0.0, sum = 0.0;
  for (const double c : coefficients) most = std::max(most, std::abs(c));
  for (std::size_t i = 0; i < order.size(); ++i) {
    sum += coefficients[order[i]];
    RC_ASSERT(std::abs(sum) <= most);
    for (std::size_t j = 0; j < i; ++j)
      if (coefficients[order[j]] == coefficients[order[i]]) RC_ASSERT(order[j] < order[i]);
  }
}
