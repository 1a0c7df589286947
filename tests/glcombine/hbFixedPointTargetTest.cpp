#include "glcombine/hbFixedPointTarget.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "sparsegrid/hbIndexSet.h"

namespace {

/// The terms of a combination at a point: coefficient and the component grid's value in [0,1], for a field scaled to
/// it.
struct Term {
  double coefficient, value;
};

std::vector<Term> constantTerms(int level, double value) {
  std::vector<Term> terms;
  for (const hbIndexSet::ComponentGrid& grid : hbIndexSet::regular(level, {}).componentGrids())
    terms.push_back({double(grid.coefficient), value});
  return terms;
}

/// Blends all terms, each times `scale`, in their order, and scales back.
double blended(const std::vector<Term>& terms, double scale, int bits) {
  hbFixedPointTarget target(bits);
  for (const Term& term : terms) {
    if (term.coefficient > 0)
      target.add(term.coefficient * term.value * scale);
    else
      target.reverseSubtract(-term.coefficient * term.value * scale);
  }
  return target.value() / scale;
}

void positiveFirst(std::vector<Term>& terms) {
  std::stable_partition(terms.begin(), terms.end(), [](const Term& t) { return t.coefficient > 0; });
}

double positiveWeight(const std::vector<Term>& terms) {
  double sum = 0.0;
  for (const Term& term : terms) sum += std::max(term.coefficient, 0.0);
  return sum;
}

} // namespace

TEST(hbFixedPointTarget, RoundsToTheNearestStepAndClampsAtBothEnds) {
  hbFixedPointTarget target(8);
  target.add(100.4 / 255.0);
  EXPECT_EQ(target.value(), 100.0 / 255.0);
  target.add(-0.5); // what is drawn is clamped, too
  EXPECT_EQ(target.value(), 100.0 / 255.0);
  target.add(0.9);
  EXPECT_EQ(target.value(), 1.0);
  target.reverseSubtract(0.2);
  EXPECT_EQ(target.value(), 204.0 / 255.0);
  target.reverseSubtract(1.0);
  EXPECT_EQ(target.value(), 0.0);
}

// Fig. 9. All points of a plane are blended in the same order of terms, and there are data for which every order fails
// at some of them: here the two-dimensional sparse grid of level 2, f21 + f12 - f11, with the value 1 at all nodes but
// 0 at (1/4, 1/2) and (1/2, 1/4), seen at those two and at (1/2, 1/2).
TEST(hbFixedPointTarget, WithoutScalingClampingDestroysTheValueForEveryOrder) {
  const std::vector<std::vector<Term>> points{
      {{1, 0.0}, {1, 1.0}, {-1, 1.0}}, {{1, 1.0}, {1, 0.0}, {-1, 1.0}}, {{1, 1.0}, {1, 1.0}, {-1, 1.0}}};
  const auto exact = [](const std::vector<Term>& terms) {
    double sum = 0.0;
    for (const Term& term : terms) sum += term.coefficient * term.value;
    return sum;
  };
  for (const int bits : {8, 12, 16}) {
    std::vector<std::size_t> order{0, 1, 2};
    do {
      double unscaled = 0.0;
      for (const std::vector<Term>& terms : points) {
        std::vector<Term> ordered;
        for (const std::size_t i : order) ordered.push_back(terms[i]);
        unscaled = std::max(unscaled, std::abs(blended(ordered, 1.0, bits) - exact(terms)));
      }
      EXPECT_EQ(unscaled, 1.0) << bits;
    } while (std::next_permutation(order.begin(), order.end()));
    for (std::vector<Term> terms : points) {
      positiveFirst(terms);
      // Every term is off by half a step, which scaling back doubles.
      EXPECT_LE(std::abs(blended(terms, 0.5, bits) - exact(terms)), 3 * 2 * hbFixedPointTarget(bits).halfStep());
    }
  }
}

// The order of the paper, positive terms first, on a constant, of which every component grid is the constant itself.
TEST(hbFixedPointTarget, ScaledByThePositiveTermsNothingIsClamped) {
  const double value = 0.7;
  for (const int level : {3, 5, 8, 10, 11})
    for (const int bits : {8, 12, 16}) {
      std::vector<Term> terms = constantTerms(level, value);
      positiveFirst(terms);
      EXPECT_GE(std::abs(blended(terms, 1.0, bits) - value), value) << level << " " << bits; // 1, or 0
      const double weight = positiveWeight(terms);
      const double bound = double(terms.size()) * weight * hbFixedPointTarget(bits).halfStep();
      EXPECT_LE(std::abs(blended(terms, 1.0 / weight, bits) - value), bound) << level << " " << bits;
    }
}

// "Level 10: 91 positive terms, almost 7 bits, 5 of 12 left."
TEST(hbFixedPointTarget, ScalingCostsTheBitsOfTheSumOfPositiveCoefficients) {
  const std::vector<Term> terms = constantTerms(10, 1.0);
  EXPECT_EQ(std::count_if(terms.begin(), terms.end(), [](const Term& t) { return t.coefficient > 0; }), 91);
  EXPECT_NEAR(std::log2(positiveWeight(terms)), 6.5, 0.1);
}

// A combination of values of `least` and more, which is so itself, is not below what 0 in a target stands for.
TEST(hbFixedPointTarget, RangesBeginWhereCombinationsDoNotFallBelowThem) {
  EXPECT_EQ(hb::fixedPointLow(3.0, 1.0), 3.0);
  EXPECT_EQ(hb::fixedPointLow(3.0, 2.0), 1.5);
  EXPECT_EQ(hb::fixedPointLow(3.0, 0.5), 3.0);
  EXPECT_EQ(hb::fixedPointLow(-3.0, 2.0), -3.0);
  EXPECT_EQ(hb::fixedPointLow(-3.0, 0.5), -6.0);
  EXPECT_EQ(hb::fixedPointLow(-3.0, 0.0), -3.0);
}
