#include "volume/fields/hbCavityFlow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

using Quantity = hbCavityFlow::Quantity;
using Line = std::vector<double>;
struct Point {
  double at, value;
};

// Re = 1000, all walls rigid: S. Albensoeder, H. C. Kuhlmann, Accurate three-dimensional lid-driven cavity flow,
// J. Comput. Phys. 206 (2005) 536-558, tables 5 and 6 (Chebyshev collocation, 96 x 96 x 64), as transcribed in
// github.com/tum-pbs/PICT, tests/validations.py, commit a95d7f9d; turned from their cavity, [-1/2, 1/2]^3 with the lid
// at x = -1/2 moving along y: our y is 1/2 - x, our x is 1/2 + y, our v is minus their u.
constexpr std::array<Point, 15> kPublishedU{{{0.0547, -0.20623},
                                             {0.0625, -0.22283},
                                             {0.0703, -0.23696},
                                             {0.1016, -0.27293},
                                             {0.1719, -0.25160},
                                             {0.2813, -0.10999},
                                             {0.4531, -0.00612},
                                             {0.5000, 0.00802},
                                             {0.6172, 0.03905},
                                             {0.7344, 0.07334},
                                             {0.8516, 0.12183},
                                             {0.9531, 0.33171},
                                             {0.9609, 0.39821},
                                             {0.9688, 0.48443},
                                             {0.9766, 0.58964}}};
constexpr std::array<Point, 15> kPublishedV{{{0.0625, 0.21738},
                                             {0.0703, 0.22746},
                                             {0.0781, 0.23503},
                                             {0.0938, 0.24407},
                                             {0.1563, 0.22924},
                                             {0.2266, 0.17580},
                                             {0.2344, 0.16987},
                                             {0.5000, 0.03674},
                                             {0.8047, -0.15223},
                                             {0.8594, -0.31117},
                                             {0.9063, -0.43423},
                                             {0.9453, -0.33511},
                                             {0.9531, -0.29032},
                                             {0.9609, -0.24095},
                                             {0.9688, -0.18864}}};

/// The nodes of u along y at x = z = 1/2, or of v along x at y = z = 1/2.
Line centreLine(const hbCavityFlow& flow, Quantity quantity) {
  const std::vector<float> values = flow.nodal(quantity);
  const std::int64_t n = flow.geometry().size.x, middle = n / 2;
  Line line;
  for (std::int64_t i = 0; i < n; ++i)
    line.push_back(double(quantity == Quantity::velocityX ? values[std::size_t((middle * n + i) * n + middle)]
                                                          : values[std::size_t((middle * n + middle) * n + i)]));
  return line;
}

/// Between nodes: the cubic through the four around `at`.
double cubic(const Line& line, double at) {
  const std::int64_t n = std::int64_t(line.size());
  const double x = at * double(n - 1);
  const std::int64_t first = std::clamp(std::int64_t(x) - 1, std::int64_t{0}, n - 4);
  double sum = 0.0;
  for (std::int64_t i = 0; i < 4; ++i) {
    double weight = 1.0;
    for (std::int64_t j = 0; j < 4; ++j)
      if (j != i) weight *= (x - double(first + j)) / double(i - j);
    sum += weight * line[std::size_t(first + i)];
  }
  return sum;
}

double rootMeanSquare(const std::array<Point, 15>& points, const auto& difference) {
  double sum = 0.0;
  for (const Point& p : points) sum += difference(p) * difference(p);
  return std::sqrt(sum / double(points.size()));
}

hbCavityFlow steady(const hbCavityFlow::Parameters& parameters, std::int64_t nodes, double tolerance) {
  hbCavityFlow flow(parameters, nodes);
  EXPECT_TRUE(flow.runToSteady(tolerance, 4000));
  EXPECT_LE(flow.residual(), tolerance);
  return flow;
}

} // namespace

TEST(hbCavityFlow, AgreesWithPublishedVelocities) {
  // The grid convergence index (Roache, J. Fluids Eng. 116, 1994) for two grids of a second-order scheme: the finer
  // one's error is below 3 times |fine - coarse| / (r^2 - 1), r = 36/24, here in the mean over a line. The published
  // figures are spectral, with five decimals; stopping at changes of 0.002 per unit of time is far below the grids'
  // error.
  const hbCavityFlow coarse = steady({}, 25, 0.002), fine = steady({}, 37, 0.002);
  for (const auto& [quantity, published] :
       {std::pair(Quantity::velocityX, kPublishedU), std::pair(Quantity::velocityY, kPublishedV)}) {
    const Line a = centreLine(coarse, quantity), b = centreLine(fine, quantity);
    const double apart = rootMeanSquare(published, [&](const Point& p) { return cubic(b, p.at) - cubic(a, p.at); });
    const double before = rootMeanSquare(published, [&](const Point& p) { return cubic(a, p.at) - p.value; });
    const double error = rootMeanSquare(published, [&](const Point& p) { return cubic(b, p.at) - p.value; });
    EXPECT_LT(error, 3.0 * apart / 1.25);
    EXPECT_LT(error, before);
  }
}

TEST(hbCavityFlow, IsOfSecondOrder) {
  // Differences between grids of 8, 16 and 32 cells, over the nodes of [1/4, 3/4]^3, away from the lid's edges, where
  // the velocity jumps. Second order makes a ratio of 4, first order 2: expected is what lies nearer to 4.
  std::vector<hbCavityFlow> grids;
  for (const std::int64_t nodes : {9, 17, 33})
    grids.push_back(steady({.reynolds = 10.0, .richardson = 0.3}, nodes, 1e-4));
  for (const Quantity quantity :
       {Quantity::velocityX, Quantity::velocityY, Quantity::temperature, Quantity::pressure}) {
    std::array<std::vector<float>, 3> values;
    for (std::size_t g = 0; g < 3; ++g) values[g] = grids[g].nodal(quantity);
    const auto at = [&](std::size_t grid, std::int64_t x, std::int64_t y, std::int64_t z) {
      const std::int64_t step = std::int64_t{1} << grid, n = 8 * step + 1;
      return double(values[grid][std::size_t(((z * n + y) * n + x) * step)]);
    };
    std::array<double, 2> apart{};
    for (std::int64_t z = 2; z <= 6; ++z)
      for (std::int64_t y = 2; y <= 6; ++y)
        for (std::int64_t x = 2; x <= 6; ++x)
          for (std::size_t g = 0; g < 2; ++g) apart[g] += std::pow(at(g, x, y, z) - at(g + 1, x, y, z), 2.0);
    EXPECT_GT(std::sqrt(apart[0] / apart[1]), 2.0 * std::sqrt(2.0)) << hb::cavityQuantityName(quantity);
  }
}

TEST(hbCavityFlow, LetsInAsMuchHeatAsOut) {
  // What comes in and does not go out warms the fluid: |Nu_lid - Nu_bottom| = Re Pr |d mean(T)/dt|, at most Re Pr times
  // the residual.
  const hbCavityFlow flow = steady({.reynolds = 100.0, .richardson = 0.2}, 17, 1e-6);
  EXPECT_NEAR(flow.grid().nusseltLid(), flow.grid().nusseltBottom(), 71.0 * 1e-6);
  EXPECT_GT(flow.grid().nusseltLid(), 1.2); // stirred
}

TEST(hbCavityFlow, SlowFlowOnlyConducts) {
  // T - y solves Pe u.grad(T - y) - lap(T - y) = -Pe v with zero at lid and bottom: it is at most Pe max|v| / 8 in the
  // limit of small Pe (the solution for a constant source is a parabola), here 0.0071 / 8 with |v| below 1/2.
  const hbCavityFlow flow = steady({.reynolds = 0.01}, 9, 0.01);
  const std::vector<float> t = flow.nodal(Quantity::temperature);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(double(t[i]), double(i / 9 % 9) / 8.0, 0.0071 / 16.0 + 1e-6);
}

TEST(hbCavityFlow, FieldsAreSymmetricAndKeepTheWalls) {
  constexpr std::int64_t kN = 17;
  const hbCavityFlow flow = steady({.reynolds = 100.0, .richardson = 0.2}, kN, 0.01);
  const auto node = [](std::int64_t x, std::int64_t y, std::int64_t z) { return std::size_t((z * kN + y) * kN + x); };
  const auto u = flow.nodal(Quantity::velocityX), v = flow.nodal(Quantity::velocityY),
             w = flow.nodal(Quantity::velocityZ), t = flow.nodal(Quantity::temperature),
             p = flow.nodal(Quantity::pressure), s = flow.nodal(Quantity::speed);
  float fastestAcross = 0.0F;
  for (std::int64_t z = 0; z < kN; ++z)
    for (std::int64_t y = 0; y < kN; ++y)
      for (std::int64_t x = 0; x < kN; ++x) {
        const std::size_t here = node(x, y, z), there = node(x, y, kN - 1 - z);
        for (const auto* even : {&u, &v, &t, &p, &s}) ASSERT_EQ((*even)[here], (*even)[there]);
        ASSERT_EQ(w[here], -w[there]);
        fastestAcross = std::max(fastestAcross, w[here]);
        // Three floats, each rounded once: half a step of a float of each, and of the speed.
        ASSERT_NEAR(s[here], std::sqrt(u[here] * u[here] + v[here] * v[here] + w[here] * w[here]), 4e-7F);
        const bool side = x == 0 || x == kN - 1 || z == 0 || z == kN - 1, lid = y == kN - 1;
        // Means of a value and its reflection: exact but for one rounding of numbers below 2.
        if (side || y == 0 || lid) {
          ASSERT_NEAR(u[here], lid && !side ? 1.0F : 0.0F, 4e-16F);
          ASSERT_NEAR(v[here], 0.0F, 4e-16F);
          ASSERT_NEAR(w[here], 0.0F, 4e-16F);
        }
        if (y == 0 || lid) {
          ASSERT_NEAR(t[here], lid ? 1.0F : 0.0F, 4e-16F);
        }
      }
  EXPECT_GT(fastestAcross, 0.005F);
  // The flow turns with the lid: along +x below it, down the wall it runs into, back along the bottom, up the other.
  const std::int64_t m = kN / 2;
  EXPECT_GT(u[node(m, kN - 2, m)], 0.3F);
  EXPECT_LT(v[node(kN - 3, m, m)], -0.05F);
  EXPECT_LT(u[node(m, 4, m)], -0.05F);
  EXPECT_GT(v[node(3, m, m)], 0.05F);
  // It is stopped at the upper edge it runs into, and leaves the other one.
  EXPECT_GT(p[node(kN - 1, kN - 1, m)], 0.1F);
  EXPECT_LT(p[node(0, kN - 1, m)], 0.0F);
}

TEST(hbCavityFlow, TimeLeadsToTheSteadyFlow) {
  // The slowest mode of all is conduction's, which decays by pi^2/(Re Pr) = 1.39 per unit of time: exp(-1.39 * 12) =
  // 6e-8. Being steady within 1e-7 per unit of time leaves that over 1.39.
  const hbCavityFlow::Parameters parameters{.reynolds = 10.0, .richardson = 0.1};
  hbCavityFlow flow(parameters, 9);
  EXPECT_EQ(flow.time(), 0.0);
  EXPECT_TRUE(std::isinf(flow.residual()));
  flow.advanceTo(1.0);
  EXPECT_EQ(flow.time(), 1.0);
  const std::int64_t steps = flow.steps();
  EXPECT_GE(double(steps), 1.0 / hbStaggeredFlow(parameters, 8).stableStep());
  EXPECT_GT(flow.residual(), 1e-4);
  flow.advanceTo(12.0);
  EXPECT_EQ(flow.time(), 12.0);
  EXPECT_GT(flow.steps(), steps);
  EXPECT_LT(flow.residual(), 1e-6);
  const hbCavityFlow still = steady(parameters, 9, 1e-7);
  EXPECT_NE(still.time(), 12.0);
  for (const Quantity quantity : {Quantity::velocityX, Quantity::temperature}) {
    const auto a = flow.nodal(quantity), b = still.nodal(quantity);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 3e-7F); // and half a step of floats up to 1
  }
}

TEST(hbCavityFlow, IsOfSecondOrderInTime) {
  // One step, two and four of equal length to the same time: the differences shrink by 4, for first order by 2.
  const auto after = [](int count) {
    hbStaggeredFlow flow({.reynolds = 20.0, .richardson = 0.5}, 8);
    for (int i = 0; i < 40; ++i) flow.step(0.005); // past the impulsive start
    for (int i = 0; i < count; ++i) flow.step(0.04 / count);
    return flow.state();
  };
  const auto one = after(1), two = after(2), four = after(4);
  double first = 0.0, second = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    first += std::pow(one[i] - two[i], 2.0);
    second += std::pow(two[i] - four[i], 2.0);
  }
  EXPECT_GT(std::sqrt(first / second), 2.0 * std::sqrt(2.0));
}

TEST(hbCavityFlow, GivesUpAndCanBeStopped) {
  hbCavityFlow flow({}, 9);
  EXPECT_FALSE(flow.runToSteady(1e-9, 16));
  EXPECT_EQ(flow.steps(), 16);
  EXPECT_GT(flow.residual(), 1e-9);
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(flow.advanceTo(flow.time() + 1.0, progress), hbCancelled);
  EXPECT_THROW(flow.runToSteady(1e-9, 1000, progress), hbCancelled);
}

TEST(hbCavityFlow, FlowsThatGrowWithoutBoundAreErrors) {
  hbCavityFlow steady({.reynolds = 10000.0, .richardson = -10.0}, 9);
  EXPECT_HB_ERROR(steady.runToSteady(5e-4, 4000), "the flow grew without bound at time ");
  // Speeds that leave no step to speak of, and forces that a single step turns into infinite speeds.
  for (const double richardson : {1e20, 1e300}) {
    hbCavityFlow stiff({.richardson = richardson}, 9);
    EXPECT_HB_ERROR(stiff.advanceTo(20.0), "expected a smaller reynolds or |richardson|, or a finer grid");
    hbCavityFlow settling({.richardson = richardson}, 9);
    EXPECT_HB_ERROR(settling.runToSteady(5e-4, 4000), "grew without bound");
  }
  // Viscosity that leaves no step at all.
  EXPECT_HB_ERROR(hbCavityFlow({.reynolds = 1e-310}, 9).runToSteady(5e-4, 4000), "grew without bound at time 0;");
}

TEST(hbCavityFlow, RefusesMoreThanAMillionSteps) {
  // Diffusion alone limits such steps: 12 * 64 / (0.01 * 0.71) / 2.45 = 44150.6 a unit of time.
  const hbCavityFlow::Parameters thick{.reynolds = 0.01};
  EXPECT_NO_THROW(hbCavityFlow::checkTime(thick, 9, 22.64));
  EXPECT_HB_ERROR(hbCavityFlow::checkTime(thick, 9, 22.66), "expected an end-time of at most 1000000 time steps");
  hbCavityFlow flow(thick, 9);
  EXPECT_HB_ERROR(flow.advanceTo(1000.0), "found 1000, which takes about 441506");
  EXPECT_EQ(flow.steps(), 0);
  EXPECT_HB_ERROR(flow.advanceTo(std::numeric_limits<double>::infinity()), "found inf");
  EXPECT_HB_ERROR(flow.advanceTo(std::numeric_limits<double>::quiet_NaN()), "found nan");
}

TEST(hbCavityFlow, TellsHowFarItIs) {
  struct Counter final : hbProgress {
    std::int64_t last = 0, total = 0, tasks = 0;
    void begin(std::string_view what, std::int64_t units, std::string_view unit) override {
      hbProgress::begin(what, units, unit);
      ++tasks;
      last = 0;
    }
    void show(std::int64_t done, std::int64_t all) override {
      EXPECT_GE(done, last);
      EXPECT_LE(done, all);
      last = done;
      total = all;
    }
  } counter;
  hbCavityFlow flow({.reynolds = 100.0}, 33);
  flow.advanceTo(0.1, counter);
  EXPECT_EQ(counter.tasks, 1);
  EXPECT_EQ(counter.last, counter.total);
  flow.runToSteady(0.01, 1000, counter);
  EXPECT_EQ(counter.tasks, 3); // on 17 and 33 nodes
  EXPECT_GT(counter.last, counter.total / 4);
}

TEST(hbCavityFlow, RefusesParameters) {
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, none, endless}) {
    EXPECT_HB_ERROR(hbCavityFlow({.reynolds = bad}, 9), "expected a positive, finite reynolds, found ");
    EXPECT_HB_ERROR(hbCavityFlow({.prandtl = bad}, 9), "expected a positive, finite prandtl, found ");
  }
  for (const double bad : {none, endless, -endless})
    EXPECT_HB_ERROR(hbCavityFlow({.richardson = bad}, 9), "expected a finite richardson, found ");
}

TEST(hbCavityFlow, RefusesSizes) {
  for (const std::int64_t nodes : {-1, 0, 7, 10, 64, 259})
    EXPECT_HB_ERROR(hbCavityFlow({}, nodes),
                    "expected an odd number of nodes from 9 to 257, found " + std::to_string(nodes));
  const hbGeometry geometry = hbCavityFlow({}, 9).geometry();
  EXPECT_EQ(geometry.size, hbSize3(9, 9, 9));
  EXPECT_EQ(geometry.extent(), glm::dvec3(1.0));
}

TEST(hbCavityFlow, QuantitiesHaveNames) {
  for (int i = 0; i < 6; ++i) EXPECT_EQ(hb::cavityQuantityFromName(hb::cavityQuantityName(Quantity(i))), Quantity(i));
  EXPECT_HB_ERROR(hb::cavityQuantityFromName("p"), "expected one of pressure, temperature");
}
