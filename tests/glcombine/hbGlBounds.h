#pragma once

#include <algorithm>
#include <cmath>

#include "sparsegrid/hbCombinationSparseGrid.h"

/// How far drawn combinations may be from exact ones.
struct hbGlBounds {
  double largest = 0.0;   ///< Nodal value.
  double weights = 0.0;   ///< Sum of the coefficients' magnitudes.
  double terms = 0.0;     ///< Number of component grids.
  double steepness = 0.0; ///< How far a step of 1 in the coordinates could move a value.

  explicit hbGlBounds(const hbCombinationSparseGrid& grid, int component = 0) {
    for (const auto& one : grid.grids()) {
      for (const float value : grid.values(one, component)) largest = std::max(largest, double(std::abs(value)));
      weights += std::abs(one.coefficient);
      ++terms;
      for (int d = 0; d < 3; ++d) steepness += std::abs(one.coefficient) * 2.0 * std::exp2(one.levels[d]);
    }
    steepness *= largest;
  }

  /// In 32-bit floats throughout. Values: as the combination engine's (18 roundings, see hbTestSets::combinationBound),
  /// with every addition in 32 bits, each of a partial sum up to the sum of the weights. Coordinates: 8 roundings of
  /// the corners, their interpolation, scale and offset, and the filter's texel.
  double floats() const { return (18.0 + terms) * 0x1p-24 * weights * largest + 8.0 * 0x1p-24 * steepness; }
};
