#pragma once

#include <span>
#include <vector>

#include "fitting/hbFitReport.h"
#include "fitting/hbFitSamples.h"
#include "fitting/hbSampleOperator.h"

/// How far a sparse grid is from the samples: those that were fitted and those that were held out.
struct hbFitErrors {
  hbFitReport::Errors fitted, heldOut;
  /// Of up to 2^20 fitted samples, irregularly spread and the same ones every time: |value - sample|.
  std::vector<float> magnitudes;
  double lo = 0.0, hi = 0.0;    ///< The range of all samples.
  double withinThreshold = 0.0; ///< The RMSE of those fitted samples at which a robust loss is still a square.

  /// What of() takes beside values.apply(), in bytes.
  static double bytes(const hbSize3& samples);

  /// One pass over the samples. Sums are added in the order of planes.
  static hbFitErrors of(const hbFitSamples& samples, const hbSampleOperator& values, std::span<const double> surpluses,
                        const hbFitLoss& loss);
};
