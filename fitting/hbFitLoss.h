#pragma once

#include <cstdint>
#include <span>
#include <string_view>

/// What a residual r = value - sample costs in a fit.
///
/// `none`: r^2 / 2. `huber`: the same up to the threshold d, and d (|r| - d/2) beyond, so that a sample far off pulls
/// no harder than one at d. Source: Huber, Robust estimation of a location parameter, Annals of Mathematical
/// Statistics 35 (1964).
struct hbFitLoss {
  enum class Kind : std::uint8_t { none, huber };

  Kind kind = Kind::none;
  double threshold = 0.0; ///< Of huber, in field values, > 0.

  double cost(double residual) const;
  /// The weight w with which w r^2 / 2 has the same slope as cost() at that residual, in (0,1].
  double weight(double residual) const;

  /// The threshold for residuals most of which are normally distributed: 1.345 standard deviations, by which the fit
  /// loses 5 % against plain least squares where all of them are. The deviation is estimated as 1.4826 times the median
  /// of the magnitudes, which up to half of them may spoil. Reorders `magnitudes`; 0 where there are none.
  static double thresholdOf(std::span<float> magnitudes);

  /// "none" or "huber".
  std::string_view name() const { return kind == Kind::huber ? "huber" : "none"; }
};
