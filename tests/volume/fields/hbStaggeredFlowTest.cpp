#include "volume/fields/hbStaggeredFlow.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

namespace {

using Field = hbStaggeredFlow::Field;

hbStaggeredFlow advanced(const hbStaggeredFlow::Parameters& parameters, std::int64_t cells, int steps) {
  hbStaggeredFlow flow(parameters, cells);
  for (int i = 0; i < steps; ++i) flow.step(flow.stableStep());
  return flow;
}

double largest(const hbStaggeredFlow& flow, Field field) {
  const double* const q = flow.field(field);
  return std::abs(
      *std::max_element(q, q + flow.fieldSize(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
}

} // namespace

TEST(hbStaggeredFlow, StartsAtRestWithConduction) {
  const hbStaggeredFlow flow({}, 8);
  EXPECT_EQ(flow.cells(), 8);
  EXPECT_EQ(flow.fieldSize(), 10 * 10 * 6);
  EXPECT_EQ(flow.state().size(), 4U * 600U);
  EXPECT_EQ(flow.largestDivergence(), 0.0);
  // The slope of T = y; sums of 32 exact numbers.
  EXPECT_EQ(flow.nusseltLid(), 1.0);
  EXPECT_EQ(flow.nusseltBottom(), 1.0);
}

TEST(hbStaggeredFlow, HasNoDivergence) {
  const hbStaggeredFlow flow = advanced({.reynolds = 400.0, .richardson = 0.5}, 16, 40);
  EXPECT_GT(largest(flow, hbStaggeredFlow::kW), 0.01);
  // What a projection subtracts is h^-1 differences of p dt; its divergence comes back up to roundings of the solution,
  // eps/2 times the six sums of 16 terms, times the operator's norm 12/h^2 and p dt (pressures are below 1 here).
  EXPECT_LT(flow.largestDivergence(), 1.1e-16 * 6 * 16 * 12 * 256 * flow.stableStep());
}

TEST(hbStaggeredFlow, DoesNotDependOnThreads) {
  std::vector<double> first, pressure;
  for (const std::size_t threads : {1, 2, 5}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    const hbStaggeredFlow flow = advanced({.richardson = 0.1}, 10, 5);
    if (first.empty()) {
      first = flow.state();
      pressure = flow.pressure();
    }
    EXPECT_TRUE(flow.state() == first) << threads;
    EXPECT_TRUE(flow.pressure() == pressure) << threads;
  }
}

TEST(hbStaggeredFlow, StableStepIsThatOfTheEllipse) {
  const auto expected = [](double diffusivity, double speed, double n) {
    return 1.0 / std::hypot(12.0 * n * n * diffusivity / 2.45, speed * n / 2.6);
  };
  // At rest the lid is fastest. The better of the two conductors limits diffusion.
  EXPECT_DOUBLE_EQ(hbStaggeredFlow({.reynolds = 100.0, .prandtl = 0.5}, 8).stableStep(), expected(0.02, 1.0, 8.0));
  EXPECT_DOUBLE_EQ(hbStaggeredFlow({.reynolds = 100.0, .prandtl = 7.0}, 8).stableStep(), expected(0.01, 1.0, 8.0));
  // A speed of 2 + 1 in one cell.
  hbStaggeredFlow flow({.reynolds = 100.0, .prandtl = 1.0}, 8);
  std::vector<double> state = flow.state();
  const std::int64_t at = 2 * flow.strideZ() + 3 * flow.strideY() + 4;
  state[std::size_t(at)] = -2.0;
  state[std::size_t(2 * flow.fieldSize() + at)] = 1.0;
  flow.setState(state);
  EXPECT_DOUBLE_EQ(flow.stableStep(), expected(0.01, 3.0, 8.0));
}

TEST(hbStaggeredFlow, ValuesThatAreNoNumbersAreNotOverlooked) {
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  hbStaggeredFlow flow({}, 8);
  const std::vector<double> before = flow.state();
  const auto at = std::size_t(2 * flow.strideZ() + 3 * flow.strideY() + 4);
  // The value beside it, which is looked at afterwards, is larger than all before.
  const auto set = [&](double value) {
    std::vector<double> state = before;
    state[at] = value;
    state[at + 1] = 5.0;
    flow.setState(state);
  };
  set(1.0);
  EXPECT_EQ(flow.largestChange(before), 5.0);
  EXPECT_EQ(flow.largestDivergence(), 40.0); // 8 (5 - 0), beside 8 (5 - 1) and 8 (1 - 0)
  set(none);
  EXPECT_TRUE(std::isnan(flow.stableStep()));
  EXPECT_TRUE(std::isnan(flow.largestChange(before)));
  EXPECT_TRUE(std::isnan(flow.largestDivergence()));
  set(endless);
  EXPECT_EQ(flow.stableStep(), 0.0);
  EXPECT_EQ(flow.largestChange(before), endless);
}

TEST(hbStaggeredFlow, StaysBoundedAtTheStableStep) {
  // At twice the step both blow up within the 60 steps: one by diffusion, one by convection.
  for (const double reynolds : {1.0, 10000.0}) {
    const hbStaggeredFlow::Parameters parameters{.reynolds = reynolds};
    EXPECT_LT(largest(advanced(parameters, 8, 60), hbStaggeredFlow::kU), 2.5) << reynolds;
  }
  hbStaggeredFlow wild({.reynolds = 1.0}, 8);
  for (int i = 0; i < 60; ++i) wild.step(2.0 * hbStaggeredFlow({.reynolds = 1.0}, 8).stableStep());
  EXPECT_FALSE(largest(wild, hbStaggeredFlow::kT) < 2.5);
}

TEST(hbStaggeredFlow, RestingFluidHasTheHydrostaticPressure) {
  // dp/dy = Ri (T - 1/2) with T = y: p = Ri (y^2 - y)/2 + constant, whose central differences are exact. What the lid
  // does to the pressure is the same with and without buoyancy, as the equation is linear in its right side.
  const hbStaggeredFlow still({.richardson = 0.0}, 8), light({.richardson = 3.0}, 8);
  const std::vector<double> without = still.pressure(), with = light.pressure();
  const auto y = [](std::int64_t j) { return (double(j) - 0.5) / 8.0; };
  double mean = 0.0;
  for (std::int64_t j = 1; j <= 8; ++j) mean += 1.5 * (y(j) * y(j) - y(j)) / 8.0;
  for (std::int64_t k = 1; k <= 4; ++k)
    for (std::int64_t j = 1; j <= 8; ++j)
      for (std::int64_t i = 1; i <= 8; ++i) {
        const auto at = std::size_t(k * still.strideZ() + j * still.strideY() + i);
        EXPECT_NEAR(with[at] - without[at], 1.5 * (y(j) * y(j) - y(j)) - mean, 1e-13);
      }
}

TEST(hbStaggeredFlow, PressureHasMeanZeroAndGoesOnLinearly) {
  const hbStaggeredFlow flow = advanced({}, 8, 20);
  const std::vector<double> p = flow.pressure();
  const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return p[std::size_t(k * flow.strideZ() + j * flow.strideY() + i)];
  };
  double sum = 0.0, most = 0.0;
  for (std::int64_t k = 1; k <= 4; ++k)
    for (std::int64_t j = 1; j <= 8; ++j)
      for (std::int64_t i = 1; i <= 8; ++i) {
        sum += at(i, j, k);
        most = std::max(most, std::abs(at(i, j, k)));
      }
  EXPECT_GT(most, 0.01);
  EXPECT_NEAR(sum / 256.0, 0.0, 1e-14);
  EXPECT_DOUBLE_EQ(at(0, 3, 2), 2.0 * at(1, 3, 2) - at(2, 3, 2));
  EXPECT_DOUBLE_EQ(at(9, 9, 2), 2.0 * at(9, 8, 2) - at(9, 7, 2));
  EXPECT_DOUBLE_EQ(at(4, 3, 0), 2.0 * at(4, 3, 1) - at(4, 3, 2));
  EXPECT_EQ(at(4, 3, 5), at(4, 3, 4)); // symmetry
}

TEST(hbStaggeredFlow, InterpolatesLinearlyBetweenGrids) {
  // A temperature that is linear along each axis comes over exactly, from coarser and from finer grids of any ratio.
  const auto fill = [](const hbStaggeredFlow& flow) {
    std::vector<double> state = flow.state();
    const double h = flow.width();
    for (std::int64_t at = 0; at < flow.fieldSize(); ++at) {
      const double x = (double(at % flow.strideY()) - 0.5) * h,
                   y = (double(at / flow.strideY() % flow.strideY()) - 0.5) * h,
                   z = (double(at / flow.strideZ()) - 0.5) * h;
      state[std::size_t(hbStaggeredFlow::kT * flow.fieldSize() + at)] = 1.0 + x + 2.0 * y - z + x * y * z;
    }
    return state;
  };
  for (const auto& [from, to] : {std::pair(4, 8), std::pair(8, 4), std::pair(6, 10)}) {
    hbStaggeredFlow source({}, from), target({}, to);
    source.setState(fill(source));
    target.interpolate(source);
    const std::vector<double> expected = fill(target);
    for (std::int64_t k = 1; k <= to / 2; ++k)
      for (std::int64_t j = 1; j <= to; ++j)
        for (std::int64_t i = 1; i <= to; ++i) {
          const std::int64_t at = k * target.strideZ() + j * target.strideY() + i;
          EXPECT_NEAR(target.field(hbStaggeredFlow::kT)[at],
                      expected[std::size_t(hbStaggeredFlow::kT * target.fieldSize() + at)], 1e-14);
        }
  }
}

TEST(hbStaggeredFlow, InterpolatesVelocitiesWithoutDivergence) {
  const hbStaggeredFlow source = advanced({}, 12, 40);
  // Onto the same grid nothing changes but the last digits, by a projection of what has no divergence.
  hbStaggeredFlow same({}, 12);
  same.interpolate(source);
  double most = 0.0;
  for (std::size_t i = 0; i < same.state().size(); ++i)
    most = std::max(most, std::abs(same.state()[i] - source.state()[i]));
  EXPECT_LT(most, 1e-13);
  hbStaggeredFlow fine({}, 18);
  fine.interpolate(source);
  // As in HasNoDivergence, with a potential below 1 times a cell's width: velocities change by less than 1.
  EXPECT_LT(fine.largestDivergence(), 1.1e-16 * 6 * 18 * 12 * 18);
  EXPECT_NEAR(largest(fine, hbStaggeredFlow::kV), largest(source, hbStaggeredFlow::kV), 0.1);
}

TEST(hbStaggeredFlow, WarmLidOnTopDampsAndColdLidDrives) {
  const auto fastest = [](double richardson) {
    return largest(advanced({.reynolds = 200.0, .richardson = richardson}, 12, 150), hbStaggeredFlow::kV);
  };
  const double damped = fastest(1.0), plain = fastest(0.0), driven = fastest(-1.0);
  EXPECT_LT(damped, 0.9 * plain);
  EXPECT_GT(driven, 1.1 * plain);
}
