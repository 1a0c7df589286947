#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fitting/hbFitLoss.h"
#include "fitting/hbFitSamples.h"
#include "sparsegrid/hbIndexSet.h"
#include "volume/hbProgress.h"

/// The least-squares problem of a sparse grid: over the surpluses a, minimise
///
///     1/M sum over the M fitted samples of cost(s(x_j) - f_j)  +  smoothing/2 sum over the nodes i of w_i a_i^2
///
/// with w_i the product of 2^(l+1) over the axes of whose level l >= 1 node i is, and 0 at the corners of the cube. As
/// the hats of one axis are orthogonal by their slopes, with squared norm 2^(l+1), the second sum is the integral of
/// the squared mixed derivative of the surpluses' functions over the inside, the faces and the edges of the cube: 0 for
/// trilinear functions, so that constants added to the data are added to the fit.
struct hbLeastSquares {
  const hbFitSamples& samples;
  const hbIndexSet& set;
  hbFitLoss loss;         ///< With its threshold.
  double smoothing = 0.0; ///< >= 0.

  /// w_i for the nodes of a subspace.
  static double smoothingWeight(const glm::ivec3& levels);

  /// The first axis with more nodes than its samples determine, or -1. Exactly then the problem has several minimisers
  /// without smoothing (before samples are held out): an axis' hats are independent on its samples if each node in turn
  /// finds another sample inside its hat (Schoenberg and Whitney), and products of independent functions are.
  int undeterminedAxis() const;

  struct Solution {
    std::vector<double> surpluses; ///< In the order of set.subspaces().
    std::int64_t iterations = 0;   ///< Of the linear solver, all together.
    int rounds = 0;                ///< Of the outer loop of a robust loss.
    bool converged = false;
    bool interrupted = false;                                    ///< `progress` was cancelled: the best so far.
    double condition = std::numeric_limits<double>::quiet_NaN(); ///< Estimate; NaN: not known.
  };
};
