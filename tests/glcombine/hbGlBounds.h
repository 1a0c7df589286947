#pragma once

#include <algorithm>
#include <cmath>

#include "raycast/hbPlaneRays.h"
#include "sparsegrid/hbCombinationSparseGrid.h"

/// How far combinations drawn in 32 bits may be from those of the combination engine, and how far both from exact ones.
class hbGlBounds {
public:
  /// On planes within [0,1] and a bit.
  explicit hbGlBounds(const hbCombinationSparseGrid& grid, int component = 0) {
    for (const auto& one : grid.grids()) {
      for (const float value : grid.values(one, component)) largest_ = std::max(largest_, double(std::abs(value)));
      weights_ += std::abs(one.coefficient);
      ++terms_;
      for (int d = 0; d < 3; ++d) steepness_ += std::abs(one.coefficient) * 2.0 * std::exp2(one.levels[d]);
    }
    steepness_ *= largest_;
  }

  /// On the planes of a picture, which may reach far beyond the cube.
  hbGlBounds(const hbCombinationSparseGrid& grid, const hbPlaneRays& rays) : hbGlBounds(grid, rays.scene().component) {
    planes_ = rays.planes();
    for (const int i : {0, rays.planes() - 1}) {
      const hbPlaneRays::Plane plane = rays.plane(i);
      for (const double x : {0.0, double(rays.scene().width)})
        for (const double y : {0.0, double(rays.scene().height)})
          for (int d = 0; d < 3; ++d)
            reach_ = std::max(reach_, std::abs(plane.corner[d] + x * plane.right[d] + y * plane.down[d]));
    }
  }

  /// Magnitude of a nodal value.
  double largest() const { return largest_; }
  /// Of a coordinate in the cube.
  double reach() const { return reach_; }

  /// From exact values, in 32-bit floats throughout. Values: as the combination engine's (18 roundings, see
  /// hbTestSets::combinationBound), with every addition in 32 bits, each of a partial sum up to the sum of the weights.
  /// Coordinates: 8 roundings of the corners, their interpolation across up to three tiles, scale and offset, and the
  /// filter's texel.
  double floats() const {
    return (18.0 + terms_) * 0x1p-24 * weights_ * largest_ + 8.0 * 0x1p-24 * 3.0 * reach_ * steepness_;
  }
  /// Texels off by `rounding` times the range of the nodal values, which is at most twice the greatest.
  hbGlBounds& withTexels(double rounding) {
    texels_ = rounding * 2.0 * largest_ * weights_;
    return *this;
  }

  /// Between a drawn value and the combination engine's.
  double values() const { return 2.0 * floats() + texels_; }
  /// Between sums over planes times the part of a unit length between two: of as many values, added up in 32 bits,
  /// none of which exceeds the sum of the weights.
  double sums() const { return values() + planes_ * 0x1p-24 * weights_ * largest_; }

private:
  double largest_ = 0.0;   ///< Nodal value.
  double weights_ = 0.0;   ///< Sum of the coefficients' magnitudes.
  double terms_ = 0.0;     ///< Number of component grids.
  double steepness_ = 0.0; ///< How far a step of 1 in the coordinates could move a value.
  double reach_ = 1.0;     ///< Largest coordinate.
  double planes_ = 0.0;
  double texels_ = 0.0;
};
