#include "report/hbLogAxis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace {

constexpr double kLeast = 1e-100, kGreatest = 1e100; // what is beyond lies at the end, so that nothing overflows

/// mantissa * 10^exponent: 0.002, 50, 1e-6.
std::string label(int mantissa, int exponent) {
  if (exponent < -3 || exponent > 4) return fmt::format("{}e{}", mantissa, exponent);
  return exponent < 0 ? fmt::format("{:.{}f}", mantissa * std::pow(10.0, exponent), -exponent)
                      : fmt::format("{:.0f}", mantissa * std::pow(10.0, exponent));
}

std::vector<hbLogAxis::Tick> ticksWithin(double lo, double hi) {
  constexpr double kShort = 3.0; // decades
  constexpr int kMost = 8;       // labels that fit
  const double decades = std::log10(hi / lo);
  const std::vector<int> mantissas = decades <= kShort ? std::vector{1, 2, 5} : std::vector{1};
  const int step = std::max(1, int(std::ceil(decades / kMost)));
  std::vector<hbLogAxis::Tick> ticks;
  for (int exponent = int(std::floor(std::log10(lo))); exponent <= int(std::ceil(std::log10(hi))); ++exponent)
    for (const int mantissa : mantissas) {
      const double value = mantissa * std::pow(10.0, exponent);
      if (exponent % step == 0 && value >= lo && value <= hi) ticks.push_back({value, label(mantissa, exponent)});
    }
  return ticks;
}

} // namespace

hbLogAxis hbLogAxis::of(std::span<const double> values) {
  constexpr double kMargin = 1.25, kDecade = 10.0;
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  bool zeros = false;
  for (const double value : values) {
    zeros = zeros || value <= 0.0;
    if (value <= 0.0) continue;
    least = std::min(least, std::clamp(value, kLeast, kGreatest));
    greatest = std::max(greatest, std::clamp(value, kLeast, kGreatest));
  }
  hbLogAxis axis;
  if (greatest > 0.0) {
    axis.lo = least / kMargin;
    axis.hi = greatest * kMargin;
    const double widen = std::max(1.0, std::sqrt(kDecade / (axis.hi / axis.lo)));
    axis.lo /= widen;
    axis.hi *= widen;
  }
  axis.ticks = ticksWithin(axis.lo, axis.hi);
  if (zeros) { // below the scale, apart by a share of its length
    const double length = axis.hi / axis.lo;
    axis.zero = axis.lo * std::pow(length, -0.08);
    axis.lo *= std::pow(length, -0.14);
    axis.ticks.insert(axis.ticks.begin(), {*axis.zero, "0"});
  }
  return axis;
}

double hbLogAxis::place(double value) const {
  return value > 0.0 ? std::clamp(value, kLeast, kGreatest) : zero.value_or(lo);
}
