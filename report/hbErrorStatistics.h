#pragma once

#include <cstdint>
#include <limits>
#include <optional>

/// Errors of values against a reference, added up in 64 bits.
///
/// Sums depend on the order of add() and merge(), so a caller that wants results free of the number of threads merges
/// fixed parts in a fixed order. Equal values (infinities too) and NaN on both sides are no error; NaN or an infinity
/// on one side only is an infinite one. Errors beyond 1e154 overflow, those below 1e-162 vanish, in the RMSE.
struct hbErrorStatistics {
  std::int64_t count = 0;
  double max = 0.0;        ///< The greatest absolute error.
  double sumSquares = 0.0; ///< Of the errors.
  /// The finite reference values lie in [lo, hi]; lo > hi while there are none.
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  void add(double reference, double value);
  void merge(const hbErrorStatistics& later);

  /// The root of the mean squared error; 0 for no values.
  double rmse() const;

  /// 20 log10((hi - lo) / rmse) in dB, the peak being the reference's value range. None where nothing differs, and
  /// where the reference has no range (one value or none); minus infinity for an infinite RMSE.
  std::optional<double> psnr() const;

  /// The same for a given peak > 0.
  std::optional<double> psnr(double peak) const;
};
