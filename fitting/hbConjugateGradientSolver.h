#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fitting/hbLeastSquares.h"
#include "fitting/hbSampleOperator.h"

/// Solves the least-squares problem of a sparse grid without ever having its matrix.
///
/// Conjugate gradients on H = T' (A'WA / M + smoothing w) T: A is hbSampleOperator, W the weights of the samples, T
/// leads from prewavelets, in which H scaled by its diagonal has a small condition number whatever the level, to
/// surpluses. A robust loss is minimised by weighting samples anew from round to round (iteratively reweighted least
/// squares: Holland and Welsch, Robust regression using iteratively reweighted least-squares, Communications in
/// Statistics 6 (1977)), each round beginning at the last one's solution; the objective falls with every round. What it
/// solves for is a correction of `start`, so a constant in the data, however large, takes no digits from the solution.
class hbConjugateGradientSolver {
public:
  /// Keeps references to samples and set.
  hbConjugateGradientSolver(const hbFitSamples& samples, const hbIndexSet& set);

  struct Settings {
    /// How far the solution is from the best one, as a root of mean squares over the samples, in shares of the root of
    /// twice the objective (which is the residual's, where little is smoothed).
    double tolerance = 1e-3;
    int mostRounds = 50; ///< Of a robust loss.
  };

  /// `problem` must be of the same samples and set. Cancelled, it returns the best so far within a plane's time.
  hbLeastSquares::Solution solve(const hbLeastSquares& problem, std::span<const double> start, const Settings& settings,
                                 hbProgress& progress = hbProgress::none()) const;

  /// H in, without weights, with the problem's smoothing: for tests of what it is.
  void apply(const hbLeastSquares& problem, std::span<const double> in, std::span<double> out) const;

  /// What solve() takes at its peak, in bytes.
  static double bytes(const hbIndexSet& set, const hbSize3& samples, hbFitLoss::Kind loss);

private:
  class Round;

  std::vector<double> diagonalOf(double meanWeight, double smoothing) const;

  const hbFitSamples& samples_;
  const hbIndexSet& set_;
  hbSampleOperator operator_;
  std::vector<double> smoothing_; ///< hbLeastSquares::smoothingWeight() of each node.
  /// Of each prewavelet: its mean square over the samples, and what the smoothing's sum has for it.
  std::vector<double> norm_, energy_;
};
