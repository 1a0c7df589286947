#include "volume/fields/hbBoxPoisson.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

namespace {

/// The operator itself: differences to the neighbours inside the box.
std::vector<double> laplacian(const std::vector<double>& p, const hbSize3& n, double width) {
  const std::int64_t strides[3] = {1, n.x, n.x * n.y};
  std::vector<double> out(p.size(), 0.0);
  for (std::int64_t i = 0; i < std::int64_t(p.size()); ++i) {
    const hbSize3 at{i % n.x, i / n.x % n.y, i / (n.x * n.y)};
    for (int d = 0; d < 3; ++d) {
      if (at[d] > 0) out[std::size_t(i)] += p[std::size_t(i - strides[d])] - p[std::size_t(i)];
      if (at[d] + 1 < n[d]) out[std::size_t(i)] += p[std::size_t(i + strides[d])] - p[std::size_t(i)];
    }
    out[std::size_t(i)] /= width * width;
  }
  return out;
}

double mean(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0) / double(v.size()); }

} // namespace

RC_GTEST_PROP(hbBoxPoisson, FindsTheSolutionOfAnyRightSide, ()) {
  const auto count = [] { return std::int64_t(*rc::gen::inRange(2, 14)); };
  const hbSize3 n{count(), count(), count()};
  const double width = 1.0 / double(*rc::gen::inRange(1, 20));
  std::vector<double> exact(std::size_t(n.x * n.y * n.z));
  for (double& v : exact) v = *rc::gen::inRange(-1000, 1001) / 1000.0;
  const double middle = mean(exact);
  for (double& v : exact) v -= middle;
  std::vector<double> values = laplacian(exact, n, width);
  // A constant more on the right side has no effect.
  for (double& v : values) v += 7.0;
  hbBoxPoisson(n, width).solve(values);
  // The operator's norm is at most 12/h^2, its smallest eigenvalue at least 4/h^2 sin^2(pi/26) > 0.057/h^2: relative
  // errors grow 210-fold at most in the norm, which is below sqrt(13^3) = 47. Six sums of up to 13 terms and the right
  // side's 7 terms round below 13 * 6 + 7 times eps/2 = 1e-14; the constant 7, 7 h^2 / 0.057 of the solution, the same.
  const double bound = 1e-14 * 210.0 * 47.0 * (2.0 + 7.0 * width * width);
  for (std::size_t i = 0; i < values.size(); ++i) RC_ASSERT(std::abs(values[i] - exact[i]) <= bound);
}

TEST(hbBoxPoisson, SolvesForACosine) {
  // cos(pi k (i+1/2)/n) is an eigenvector; its eigenvalue is the second difference of the cosine.
  constexpr std::int64_t kN = 6;
  const double width = 0.5, angle = std::acos(-1.0) * 2.0 / double(kN);
  std::vector<double> values;
  for (std::int64_t i = 0; i < kN * 2 * 3; ++i) values.push_back(std::cos(angle * (double(i % kN) + 0.5)));
  std::vector<double> solved = values;
  hbBoxPoisson({kN, 2, 3}, width).solve(solved);
  const double eigenvalue = (2.0 * std::cos(angle) - 2.0) / (width * width);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(solved[i], values[i] / eigenvalue, 1e-14);
}

TEST(hbBoxPoisson, DoesNotDependOnThreads) {
  std::vector<double> values(std::size_t(16 * 12 * 10));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(double(i) * double(i));
  std::vector<double> first;
  for (const std::size_t threads : {1, 2, 5}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    std::vector<double> solved = values;
    hbBoxPoisson({16, 12, 10}, 0.1).solve(solved);
    if (first.empty()) first = solved;
    EXPECT_TRUE(solved == first) << threads;
  }
}
