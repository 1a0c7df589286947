#pragma once

#include "raycast/hbPlaneRays.h"
#include "sparsegrid/hbCombinationSparseGrid.h"

/// How far combinations drawn in 32 bits may be from those of the combination engine, and how far both from exact ones.
class hbOglRoundingBounds {
public:
  /// On planes within [0,1] and a bit. O(values of the combination).
  explicit hbOglRoundingBounds(const hbCombinationSparseGrid& grid, int component = 0);

  /// On the planes of a picture, which may reach far beyond the cube.
  hbOglRoundingBounds(const hbCombinationSparseGrid& grid, const hbPlaneRays& rays);

  /// A coordinate's rounding, of the largest one: 8 roundings of the corners, their interpolation across up to three
  /// tiles, scale and offset, and the filter's texel.
  static constexpr double kCoordinate = 8.0 * 0x1p-24 * 3.0;

  /// Magnitude of a nodal value.
  double largest() const { return largest_; }
  /// Of a coordinate in the cube.
  double reach() const { return reach_; }

  /// From exact values, in 32-bit floats throughout. Values: as the combination engine's (see hb::combinationBound),
  /// with every addition in 32 bits, each of a partial sum up to the sum of the weights. Coordinates: kCoordinate.
  double floats() const;
  /// Texels off by `rounding` times the range of the nodal values, which is at most twice the greatest.
  hbOglRoundingBounds& withTexels(double rounding);

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

/// How far what hbOglValues evaluates at a point may be from exact values.
namespace hb {

/// As the combination engine's (hb::combinationBound), but that additions are in 32 bits, too, each of a partial sum up
/// to the sum of the coefficients.
double oglCombinationBound(const hbSparseGrid& grid, int component = 0);

/// As the semi-nodal engine's (hb::semiNodalBound), but that 1 - |kind t - ...| is rounded absolutely, by 2^-25, which
/// the four terms of a base grid sum up (2 roundings more), and that the step along x is a + t (b - a), which takes 5
/// roundings (see there) instead of 3.
constexpr double kOglSemiNodalMore = 4.0;
double oglSemiNodalBound(const hbSparseGrid& grid, int component = 0);

} // namespace hb
