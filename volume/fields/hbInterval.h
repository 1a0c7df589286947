#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

/// A closed interval that encloses the values of a formula over a box: the analytic fields' range(). Rounding is not
/// directed; who uses the result widens it (hbAnalyticField::range does).
struct hbInterval {
  double lo = 0.0, hi = 0.0;

  hbInterval() = default;
  hbInterval(double constant) : lo(constant), hi(constant) {} // NOLINT(google-explicit-constructor)
  hbInterval(double l, double h) : lo(l), hi(h) {}
};

inline hbInterval operator-(const hbInterval& a) { return {-a.hi, -a.lo}; }
inline hbInterval operator+(const hbInterval& a, const hbInterval& b) { return {a.lo + b.lo, a.hi + b.hi}; }
inline hbInterval operator-(const hbInterval& a, const hbInterval& b) { return {a.lo - b.hi, a.hi - b.lo}; }
inline hbInterval operator*(const hbInterval& a, const hbInterval& b) {
  const auto [lo, hi] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
  return {lo, hi};
}

namespace hb::formula {

inline hbInterval abs(const hbInterval& a) {
  if (a.lo >= 0.0) return a;
  if (a.hi <= 0.0) return -a;
  return {0.0, std::max(-a.lo, a.hi)};
}
inline hbInterval square(const hbInterval& a) {
  const hbInterval m = abs(a);
  return {m.lo * m.lo, m.hi * m.hi};
}
inline hbInterval exp(const hbInterval& a) { return {std::exp(a.lo), std::exp(a.hi)}; }
inline hbInterval sqrt(const hbInterval& a) { return {std::sqrt(std::max(a.lo, 0.0)), std::sqrt(std::max(a.hi, 0.0))}; }
inline hbInterval step(const hbInterval& a) { return {a.lo >= 0.0 ? 1.0 : 0.0, a.hi >= 0.0 ? 1.0 : 0.0}; }

/// cos takes its extremes at the ends, or at a multiple of pi inside: +1 at the even ones, -1 at the odd ones.
inline hbInterval cos(const hbInterval& a) {
  constexpr double kPi = std::numbers::pi;
  auto [lo, hi] = std::minmax({std::cos(a.lo), std::cos(a.hi)}); // by value
  const double first = std::ceil(a.lo / kPi), last = std::floor(a.hi / kPi);
  const double evens = std::floor(last / 2.0) - std::ceil(first / 2.0);
  const double odds = std::floor((last - 1.0) / 2.0) - std::ceil((first - 1.0) / 2.0);
  if (evens >= 0.0) hi = 1.0;
  if (odds >= 0.0) lo = -1.0;
  return {lo, hi};
}
inline hbInterval sin(const hbInterval& a) { return cos(a - hbInterval(std::numbers::pi / 2.0)); }

} // namespace hb::formula
