#include "glcombine/hbOglPointBounds.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "glcombine/hbFixedPointTarget.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "glcombine/hbTermOrder.h"
#include "sparsegrid/hbRoundingBounds.h"

namespace {

constexpr double kUnit = 0x1p-24;
constexpr double kLeastNormal = 0x1p-126;

/// How a format rounds: numbers by `unit` of themselves, or by `least` where that is more.
struct Rounding {
  double unit = kUnit, least = kLeastNormal;
};

/// A sum and how far it may be off, term by term.
class RunningSum {
public:
  /// A term that is off by up to `error`; it is rounded, and so is the sum. `moved`: how much else the term may be
  /// because the point is another one; that counts in what is rounded.
  void add(double term, double error, double moved, const Rounding& rounding) {
    const auto rounded = [&](double number) { return std::max(rounding.unit * number, rounding.least); };
    sum_ += term;
    moved_ += moved;
    error_ += error + rounded(std::abs(term) + error + moved);
    error_ += rounded(std::abs(sum_) + error_ + moved_);
  }
  double error() const { return error_; }
  double moved() const { return moved_; }

private:
  double sum_ = 0.0, error_ = 0.0, moved_ = 0.0;
};

} // namespace

hbOglPointBounds::hbOglPointBounds(const hbPointBounds& bounds)
    : bounds_(bounds), slopes_(hb::slopeBounds(bounds.grid(), bounds.component())) {
  std::vector<double> coefficients;
  for (const auto& one : bounds.combinationGrid().grids()) {
    coefficients.push_back(one.coefficient);
    whole_ += one.coefficient;
    positive_ += std::max(one.coefficient, 0.0);
  }
  interleaved_ = hb::interleaved(coefficients);
  const auto values = bounds.combinationGrid().values(bounds.component());
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  least_ = double(*least);
  greatest_ = double(*greatest);
}

/// By how much a component grid's value changes where the point moves within its cell and those around it.
double hbOglPointBounds::moved(const hbComponentValue& one, const glm::dvec3& off) const {
  double slope = 0.0;
  for (int d = 0; d < 3; ++d)
    if (one.grid->nodes[d] > 1)
      slope += off[d] * bounds_.combinationGrid().latticeScale()[d] * std::exp2(one.grid->levels[d]) * one.range;
  return slope;
}

double hbOglPointBounds::fused(const glm::dvec3& point, const glm::dvec3& off) const {
  const std::vector<hbComponentValue> values =
      hb::componentValues(bounds_.combinationGrid(), bounds_.rounded(point), bounds_.component());
  RunningSum sum;
  for (const std::size_t i : interleaved_) {
    const hbComponentValue& one = values[i];
    const double weight = std::abs(one.grid->coefficient);
    const double error = hb::kCombinationRoundings * (kUnit * one.largest + kLeastNormal);
    sum.add(one.grid->coefficient * one.value, weight * error, weight * moved(one, off), {});
  }
  // All terms are evaluated at the same point: their sum moves as the function does.
  return sum.error() + glm::dot(slopes_, off) + bounds_.coordinates(point);
}

double hbOglPointBounds::semiNodal(const glm::dvec3& point, const glm::dvec3& off) const {
  const hbPointBounds::Magnitudes there = bounds_.magnitudes(bounds_.rounded(point));
  const double roundings = hb::semiNodalRoundings(bounds_.grid().indexSet()) + hb::kOglSemiNodalMore;
  return roundings * (kUnit * there.covering + kLeastNormal * there.terms) + bounds_.coordinates(point) +
         glm::dot(slopes_, off);
}

double hbOglPointBounds::zero(hbGlFormat format) const {
  return hb::isFixedPoint(format) ? whole_ * hb::fixedPointLow(least_, whole_) : 0.0;
}

double hbOglPointBounds::blend(const glm::dvec3& point, hbGlFormat format, const glm::dvec3& off) const {
  const std::vector<hbComponentValue> values =
      hb::componentValues(bounds_.combinationGrid(), point, bounds_.component());
  const bool isFixed = hb::isFixedPoint(format), isHalf = format == hbGlFormat::r16f;
  // Of the numbers in textures, which are values less `low` over `size`.
  const double step = format == hbGlFormat::r8 ? 1.0 / 255.0 : 1.0 / 65535.0;
  const double low = isFixed ? hb::fixedPointLow(least_, whole_) : 0.0;
  double size = isFixed ? greatest_ - low : isHalf ? std::max(std::abs(least_), std::abs(greatest_)) : 1.0;
  if (!(size > 0.0)) size = 1.0;
  const Rounding half{0x1p-10, 0x1p-14};
  RunningSum sum;
  double exact = 0.0, steps = 0.0;
  for (const std::size_t i : interleaved_) {
    const hbComponentValue& one = values[i];
    const double weight = std::abs(one.grid->coefficient), value = (one.value - low) / size,
                 largest = isFixed ? 1.0 : one.largest / size;
    const double texel = isFixed ? 0.5 * step : isHalf ? std::max(half.unit * largest, half.least) : 0.0;
    const double error =
        hb::kCombinationRoundings * (kUnit * largest + kLeastNormal) + texel + kUnit * one.largest / size;
    sum.add(one.grid->coefficient * value, weight * error, weight * moved(one, off) / size, isHalf ? half : Rounding{});
    exact += one.grid->coefficient * value;
    steps += step * positive_; // of numbers in targets, which are divided by the sum of the positive coefficients
  }
  // Every texture has coordinates of its own.
  const double floats = sum.error() + sum.moved();
  return size * (isFixed ? floats + steps + std::max(0.0, -exact) : floats);
}
