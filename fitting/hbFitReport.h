#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "fitting/hbFitLoss.h"

/// What is known of a fit of one component. Values are field values.
struct hbFitReport {
  /// Of value minus sample, over some samples.
  struct Errors {
    double rmse = std::numeric_limits<double>::quiet_NaN();
    double cost = std::numeric_limits<double>::quiet_NaN(); ///< The mean of hbFitLoss::cost().
  };

  std::string method; ///< "opticom" or "least-squares"
  std::string solver; ///< "ceres" or "conjugate-gradient"
  hbFitLoss loss;
  double smoothing = 0.0;                              ///< Of least squares, see hbLeastSquares.
  std::int64_t samples = 0, heldOut = 0, unknowns = 0; ///< `samples` are those fitted.
  std::int64_t iterations = 0;                         ///< Of the linear solver, all together.
  int rounds = 0;                                      ///< Of the loss's outer loop.
  bool converged = false;
  bool interrupted = false; ///< Stopped by the user: the best so far.
  /// Estimate of the condition number of the linear problem: of opticom's matrix (hbOpticom), of least squares in
  /// prewavelets scaled by the diagonal; NaN: not known.
  double condition = std::numeric_limits<double>::quiet_NaN();
  Errors fitted, heldOutErrors;                           ///< Of the fit.
  Errors interpolationFitted, interpolationHeldOutErrors; ///< Of interpolation, the same samples.
  /// Whether the fit costs less than interpolation on the samples held out. Otherwise interpolation was kept.
  bool improved = false;
  double seconds = 0.0;
};
