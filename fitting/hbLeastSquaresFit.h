#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "fitting/hbFitErrors.h"
#include "fitting/hbLeastSquares.h"
#include "fitting/hbSampleOperator.h"
#include "volume/hbProgress.h"

/// Finds the surpluses of a least-squares fit, and what they need to be known first: where a robust loss bends, and how
/// much to smooth.
///
/// The threshold is that of the residuals of a plain fit (hbFitLoss::thresholdOf), once: followed further, by the
/// residuals of the robust fit, it shrinks on data whose fit is very good in most places, until what is harder to
/// follow counts as outliers. The smoothing weight is tried from one that is too small to matter upwards, until the
/// samples held out cost more: each fit begins at the one before.
class hbLeastSquaresFit {
public:
  /// Solves the problem from those surpluses on, to a tolerance as hbConjugateGradientSolver's.
  using Solve = std::function<hbLeastSquares::Solution(const hbLeastSquares& problem, std::span<const double> start,
                                                       double tolerance, hbProgress& progress)>;

  hbFitLoss::Kind loss = hbFitLoss::Kind::none;
  std::optional<double> threshold; ///< Of a robust loss, in field values.
  std::optional<double> smoothing; ///< >= 0.

  struct Result {
    hbLeastSquares::Solution solution; ///< Iterations and rounds are those of all fits.
    hbFitLoss loss;
    double smoothing = 0.0;
  };

  /// Cancelled, it returns the best so far. Throws hbError where a smoothing of 0 is
  /// asked for and an axis has more nodes than its samples determine.
  Result run(const hbFitSamples& samples, const hbIndexSet& set, const hbSampleOperator& values,
             std::span<const double> start, const Solve& solve, hbProgress& progress) const;

private:
  class Search;
};
