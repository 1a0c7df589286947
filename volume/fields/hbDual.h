#pragma once

#include <cmath>

#include <glm/vec3.hpp>

/// A value with its gradient: forward differentiation, so that each analytic field is written down once.
struct hbDual {
  double value = 0.0;
  glm::dvec3 gradient{0.0};

  hbDual() = default;
  hbDual(double constant) : value(constant) {} // NOLINT(google-explicit-constructor): constants mix into formulas
  hbDual(double v, const glm::dvec3& g) : value(v), gradient(g) {}
};

inline hbDual operator-(const hbDual& a) { return {-a.value, -a.gradient}; }
inline hbDual operator+(const hbDual& a, const hbDual& b) { return {a.value + b.value, a.gradient + b.gradient}; }
inline hbDual operator-(const hbDual& a, const hbDual& b) { return {a.value - b.value, a.gradient - b.gradient}; }
inline hbDual operator*(const hbDual& a, const hbDual& b) {
  return {a.value * b.value, a.value * b.gradient + b.value * a.gradient};
}

namespace hb::formula {

inline double square(double a) { return a * a; }
inline double step(double a) { return a >= 0.0 ? 1.0 : 0.0; }
using std::abs, std::cos, std::exp, std::sin, std::sqrt;

inline hbDual square(const hbDual& a) { return a * a; }
inline hbDual sin(const hbDual& a) { return {std::sin(a.value), std::cos(a.value) * a.gradient}; }
inline hbDual cos(const hbDual& a) { return {std::cos(a.value), -std::sin(a.value) * a.gradient}; }
inline hbDual exp(const hbDual& a) { return {std::exp(a.value), std::exp(a.value) * a.gradient}; }
/// The slope at 0 counts as 0 (the fields' own limit where they use it: they are even in the root).
inline hbDual sqrt(const hbDual& a) {
  const double root = std::sqrt(a.value);
  return {root, root > 0.0 ? a.gradient / (2.0 * root) : glm::dvec3(0.0)};
}
/// One-sided at the kink: the slope of the branch a >= 0.
inline hbDual abs(const hbDual& a) { return a.value >= 0.0 ? a : -a; }
/// 1 where a >= 0, otherwise 0; its slope is 0 everywhere (also on the jump).
inline hbDual step(const hbDual& a) { return {a.value >= 0.0 ? 1.0 : 0.0}; }

} // namespace hb::formula
