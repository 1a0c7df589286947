#include "fitting/hbLeastSquaresFit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fitting/hbFitCases.h"

namespace {

using Surpluses = std::vector<double>;

/// A search whose solutions are made up: constants, as far from samples of 0 as `error` says of a smoothing.
struct Search {
  std::vector<double> smoothings, tolerances;
  std::vector<hbFitLoss> losses;
  hbLeastSquaresFit::Result result;

  Search(const hbLeastSquaresFit& fit, const std::function<double(double smoothing)>& error,
         hbProgress& progress = hbProgress::none(), int interruptAt = -1) {
    const hbSize3 size{17, 9, 9};
    const hbFitCase zeros(std::vector<float>(std::size_t(size.x * size.y * size.z)), size, 3);
    const hbFitSamples samples = zeros.samples();
    const hbSampleOperator values(zeros.set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)});
    const Surpluses start(std::size_t(zeros.set.storedValues()));
    result = fit.run(
        samples, zeros.set, values, start,
        [&](const hbLeastSquares& problem, std::span<const double> from, double tolerance, hbProgress&) {
          smoothings.push_back(problem.smoothing);
          tolerances.push_back(tolerance);
          losses.push_back(problem.loss);
          hbLeastSquares::Solution solution;
          solution.surpluses.assign(from.begin(), from.end());
          std::fill_n(solution.surpluses.begin(), 8, error(problem.smoothing)); // the corners
          solution.iterations = 1;
          solution.rounds = 1;
          solution.converged = true;
          solution.interrupted = int(smoothings.size()) == interruptAt;
          return solution;
        },
        progress);
  }
};

} // namespace

// Costs are squares of the made-up errors. From 4^-13 (levels of up to 5 in all, plus 8) in steps of 16.
TEST(hbLeastSquaresFit, TriesSmoothingUntilItClearlyCostsMore) {
  const auto valley = [](double s) { return 1.0 + std::abs(std::log2(s) / 4.0 + 4.5); }; // least at 2^-18
  const Search search({}, valley);
  ASSERT_GE(search.smoothings.size(), 4U);
  EXPECT_EQ(search.smoothings[0], std::ldexp(1.0, -26));
  for (std::size_t i = 1; i + 1 < search.smoothings.size(); ++i)
    EXPECT_EQ(search.smoothings[i], 16.0 * search.smoothings[i - 1]);
  EXPECT_EQ(search.result.smoothing, std::ldexp(1.0, -18));
  EXPECT_EQ(search.smoothings.back(), search.result.smoothing); // solved once more, closely
  EXPECT_EQ(*(search.smoothings.end() - 2), 16.0 * search.result.smoothing);
  EXPECT_LT(search.tolerances.back(), search.tolerances.front());
  EXPECT_EQ(search.result.solution.iterations, std::int64_t(search.smoothings.size()));
  EXPECT_EQ(search.result.solution.surpluses[0], valley(search.result.smoothing));
}

TEST(hbLeastSquaresFit, SmoothsByOneAtMost) {
  const Search search({}, [](double s) { return 1.0 / (1.0 + s); });
  EXPECT_LE(search.result.smoothing, 1.0);
  EXPECT_GT(search.result.smoothing, 1.0 / 16.0);
}

// A plateau with ripples of less than 2 % of the cost does not end the search, an end below it is found.
TEST(hbLeastSquaresFit, GoesOnWhereCostsAreAlike) {
  int calls = 0;
  const Search search({}, [&](double s) { return s > 0x1p-12 ? 0.5 : 1.0 + 0.005 * double(++calls % 2); });
  EXPECT_GT(search.result.smoothing, 0x1p-12);
}

TEST(hbLeastSquaresFit, AGivenSmoothingIsSolvedOnce) {
  const Search search({hbFitLoss::Kind::none, {}, 0.25}, [](double) { return 1.0; });
  EXPECT_EQ(search.smoothings, std::vector<double>{0.25});
}

// Residuals of 2 everywhere: the threshold of their median, from a fit without a loss.
TEST(hbLeastSquaresFit, TheThresholdIsThatOfAPlainFit) {
  const Search search({hbFitLoss::Kind::huber, {}, 0.25}, [](double) { return 2.0; });
  ASSERT_EQ(search.losses.size(), 2U);
  EXPECT_EQ(search.losses[0].kind, hbFitLoss::Kind::none);
  EXPECT_EQ(search.losses[1].kind, hbFitLoss::Kind::huber);
  EXPECT_NEAR(search.losses[1].threshold, 2.0 * 1.345 * 1.4826, 1e-6);
  const Search given({hbFitLoss::Kind::huber, 0.5, 0.25}, [](double) { return 2.0; });
  ASSERT_EQ(given.losses.size(), 1U);
  EXPECT_EQ(given.losses[0].threshold, 0.5);
}

// Costs that are no numbers never are the best: the search ends with what it has.
TEST(hbLeastSquaresFit, EndsWhereCostsAreNoNumbers) {
  const Search search({}, [](double) { return std::nan(""); });
  EXPECT_FALSE(search.result.solution.surpluses.empty());
}

TEST(hbLeastSquaresFit, InterruptedItHasTheBestSoFar) {
  const Search search(
      {}, [](double s) { return 1.0 / (1.0 + s); }, hbProgress::none(), 3);
  EXPECT_EQ(search.smoothings.size(), 3U);
  EXPECT_TRUE(search.result.solution.interrupted);
  EXPECT_EQ(search.result.smoothing, search.smoothings.back());
}
