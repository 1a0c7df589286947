#pragma once

#include <span>

#include "fitting/hbLeastSquares.h"

/// Solves the least-squares problem of a sparse grid by Ceres: a trust region around an iterative linear solver, with
/// the matrix in memory.
///
/// The matrix is made of the dense pieces of hbSurplusBlocks. Each step of the trust region is one linear least-squares
/// problem, solved by conjugate gradients on its normal equations, preconditioned by the blocks of their diagonal. On
/// one thread, so that the outcome is always the same; it writes nothing.
///
/// Source: Agarwal, Mierle and others, Ceres Solver, http://ceres-solver.org.
class hbCeresSolver {
public:
  /// What solve() takes at its peak, in bytes: never less, and at most twice as much but for 2 MB. O(subspaces times
  /// samples of an axis).
  static double bytes(const hbLeastSquares& problem);

  /// `tolerance` is hbConjugateGradientSolver's. `start` and the solution are in the order of problem.set; the
  /// solution's rounds are the trust region's steps, of which the last, that gains too little to be made, is not
  /// counted nor are its iterations; its condition stays NaN. Surpluses that neither samples nor smoothing touch stay
  /// as they are. Cancelled, it returns the best so far, once the linear problem that it is at is solved. Throws
  /// hbError where samples are not finite.
  static hbLeastSquares::Solution solve(const hbLeastSquares& problem, std::span<const double> start, double tolerance,
                                        hbProgress& progress = hbProgress::none());
};
