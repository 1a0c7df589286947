#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

/// The range and ticks of a logarithmic plot axis.
struct hbLogAxis {
  struct Tick {
    double value;
    std::string label;
  };

  double lo = 0.3, hi = 30.0; ///< 0 < lo < hi, at least a decade apart.
  std::optional<double> zero; ///< Where zeros are drawn: below every positive value, above lo.
  std::vector<Tick> ticks;    ///< Increasing, within [lo, hi]; the first one is labelled "0" where there are zeros.

  /// The axis that shows all of `values`: finite ones are expected, those below 0 count as 0. Positive values keep a
  /// distance from both ends; those beyond 1e-100 and 1e100 are shown there. Ticks are at 1, 2 and 5 times powers of
  /// ten where the range is short, else at powers.
  static hbLogAxis of(std::span<const double> values);

  /// Where a value is drawn: itself, or `zero`.
  double place(double value) const;
};
