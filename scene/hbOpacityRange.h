#pragma once

#include <cstdint>
#include <vector>

#include "scene/hbTransferFunction.h"

/// The greatest opacity of a transfer function over any interval of values: what cannot be seen need not be read,
/// decoded or drawn, and what can be seen at most is what an error there can show at most.
///
/// A sparse table of maxima of powers of two over the points (M. A. Bender, M. Farach-Colton, "The LCA Problem
/// Revisited", LATIN 2000), behind a uniform grid that finds the points: O(n log n) time and memory for n points. It
/// belongs to one transfer function, a copy of whose points it keeps: another function needs another one.
class hbOpacityRange {
public:
  explicit hbOpacityRange(const hbTransferFunction& function);

  /// The greatest opacity in the closed interval [lo, hi]; exact for the function's opacity(), except that a step has
  /// the opacities of both its sides, so that a value on it may be rounded either way. Infinite ends are allowed, NaN
  /// for an end leaves the interval open on that side, and without values (lo > hi) the opacity is 0. Values that are
  /// NaN themselves are not in any interval.
  ///
  /// O(1) as long as the points of one cell of the grid (a half of their mean distance) are few, and O(log n) at worst.
  double maximum(double lo, double hi) const;

private:
  using Point = hbTransferFunction::OpacityPoint;

  /// A place where the shape changes, and the pieces on its two sides.
  struct Break {
    double value = 0.0;
    double greatest = 0.0; ///< Of the limits on both sides.
    Point above;           ///< The first point of the piece above.
    Point end;             ///< The last point of the piece above.
  };

  std::size_t cellOf(double value) const;
  std::size_t firstAtLeast(double value) const;
  double opacity(std::size_t firstBreakAtLeast, double value) const;

  std::vector<Break> breaks_;               ///< By value, all different.
  std::vector<std::vector<double>> maxima_; ///< [k][i]: of breaks i to i + 2^k - 1.
  std::vector<std::uint32_t> firstInCell_;  ///< The first break in this cell or a later one; one cell more at the end.
  double cellsPerValue_ = 0.0;
  double below_ = 0.0, above_ = 0.0; ///< Opacities beyond the first and the last break.
};
