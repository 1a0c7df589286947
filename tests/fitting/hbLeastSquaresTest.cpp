#include "fitting/hbLeastSquares.h"

#include <gtest/gtest.h>

#include "tests/fitting/hbFitCases.h"

namespace {

int undeterminedAxis(const hbFitCase& fit) {
  const hbFitSamples samples = fit.samples();
  return hbLeastSquares{samples, fit.set, {}, 0.0}.undeterminedAxis();
}

hbIndexSet regular(int level, const glm::ivec3& finest) { return hbIndexSet::regular(level, {finest, {}}); }

} // namespace

TEST(hbLeastSquares, SmoothingIsTheSquaredMixedSlope) {
  EXPECT_EQ(hbLeastSquares::smoothingWeight({0, 0, 0}), 0.0);
  // A hat of level l rises by 1 over 2^-l on both sides: 2 * 2^-l * (2^l)^2.
  EXPECT_EQ(hbLeastSquares::smoothingWeight({3, 0, 0}), 16.0);
  EXPECT_EQ(hbLeastSquares::smoothingWeight({3, 1, 2}), 16.0 * 4.0 * 8.0);
}

TEST(hbLeastSquares, AnAxisNeedsASampleForEachNode) {
  const hbSize3 size{9, 5, 6};
  const auto of = [&](const glm::ivec3& finest, hbLatticeMapping mapping = hbLatticeMapping::fitted) {
    return undeterminedAxis({hbFitCase::smoothSamples(size), size, regular(6, finest), mapping});
  };
  EXPECT_EQ(of({3, 2, 2}), -1);
  EXPECT_EQ(of({4, 2, 2}), 0);
  EXPECT_EQ(of({3, 3, 2}), 1);
  EXPECT_EQ(of({3, 2, 3}), 2); // 9 nodes, 6 samples
  // Aligned, the samples of z fill five eighths of the lattice.
  EXPECT_EQ(of({3, 2, 1}, hbLatticeMapping::aligned), -1);
  EXPECT_EQ(of({3, 2, 2}, hbLatticeMapping::aligned), 2);
}

TEST(hbLeastSquares, FlatAndTwoNodeAxesAreDetermined) {
  const hbSize3 size{17, 1, 5};
  EXPECT_EQ(undeterminedAxis({hbFitCase::smoothSamples(size), size, 4}), -1);
}
