#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fitting/hbFitLoss.h"
#include "fitting/hbFitSamples.h"
#include "sparsegrid/hbIndexSet.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbProgress.h"

/// The combination technique with fitted coefficients: over the coefficients c_l of the component grids, minimise
///
///     1/M sum over M samples of cost(sum over l of c_l P_l f(x_j) - f_j)
///
/// with P_l f the trilinear interpolant on component grid l. Nothing binds the coefficients, not even their sum.
/// Source: Hegland, Garcke, Challis, The combination technique and some generalisations, Linear Algebra and its
/// Applications 420 (2007).
///
/// The samples are those that are not held out, or mostSamples spread irregularly over them, the same ones every time.
struct hbOpticom {
  static constexpr std::int64_t kMostSamples = std::int64_t{1} << 18;

  const hbSparseGrid& grid; ///< Which interpolates.
  int component = 0;
  const hbFitSamples& samples; ///< Of that component.
  hbFitLoss loss;              ///< Huber with the threshold 0: it is estimated.
  std::int64_t mostSamples = kMostSamples;

  struct Solution {
    std::vector<double> coefficients; ///< In the order of componentGrids().
    std::int64_t samples = 0;         ///< Used.
    std::int64_t iterations = 0;      ///< Of the solver, all together.
    int rounds = 0;                   ///< Each with another threshold, where it is estimated.
    bool converged = false;           ///< The threshold, too.
    bool interrupted = false;         ///< `progress` was cancelled: the best so far.
    hbFitLoss loss;                   ///< With the threshold of the last round.
    /// Of the coefficients' directions, those that move the values on the samples by more than their rounding to 32
    /// bits does. Along others the coefficients stay those of interpolation.
    int determined = 0;
    /// Estimate of the condition number of the matrix of the P_l f(x_j), less those of the first grid (but in its own
    /// column), columns scaled to one norm; infinite where one is 0.
    double condition = std::numeric_limits<double>::quiet_NaN();
  };

  /// On the samples used, the solution never costs more than interpolation. Does not depend on the number of threads.
  /// Throws hbError where a sample is not finite. O(samples x grids^2) an iteration, one for the plain loss.
  Solution solve(hbProgress& progress = hbProgress::none()) const;

  /// The memory that solve() takes with so many samples used, on the threads there are, in bytes; a plane of samples a
  /// thread comes on top.
  static double bytes(const hbIndexSet& set, std::int64_t samples);

  /// The surpluses of the combination with those coefficients, in the order of grid.indexSet().subspaces(): those of
  /// `grid` times the sum of the coefficients of the component grids that the subspace is part of. Throws hbError for
  /// another number of coefficients.
  static std::vector<double> surpluses(const hbSparseGrid& grid, int component, std::span<const double> coefficients);
};
