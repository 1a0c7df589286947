#pragma once

#include <glm/vec3.hpp>

#include "sparsegrid/hbComponentValues.h"
#include "sparsegrid/hbSparseGrid.h"

/// The bounds of hbRoundingBounds.h at single points: the same roundings, but of what is added up at the point instead
/// of the largest there is anywhere. In field values; a number below the least normal one is rounded by half of the
/// least subnormal one instead.
class hbPointBounds {
public:
  /// Keeps references to both, which are of one grid.
  hbPointBounds(const hbSparseGrid& grid, const hbCombinationSparseGrid& combination, int component = 0);

  /// Between the engines' values at a point and the exact one. Its coordinates are 32-bit floats, and 0 or at least
  /// 2^-24. O(subspaces); `combination`: O(component grids).
  double direct(const glm::dvec3& point) const;
  double semiNodal(const glm::dvec3& point) const;
  /// In any order of axes.
  double lattice(const glm::dvec3& point) const;
  double combination(const glm::dvec3& point) const;

  /// Between the exact value and that of the surpluses before they were rounded to 32 bits.
  double stored(const glm::dvec3& point) const;

  /// What 32-bit coordinates do to the value: with the aligned mapping they are rounded once more (rounded()).
  double coordinates(const glm::dvec3& point) const;
  /// Where those who compute in 32 bits evaluate the grid.
  glm::dvec3 rounded(const glm::dvec3& point) const;

  /// Sums over the subspaces of the surplus whose hat covers the point.
  struct Magnitudes {
    double weighted = 0.0; ///< Of its magnitude times the hat's value there: no partial sum at the point exceeds it.
    double covering = 0.0; ///< Of its magnitude: no partial sum at the ends of a cell around the point does.
    double terms = 0.0;
  };
  Magnitudes magnitudes(const glm::dvec3& point) const;

  const hbSparseGrid& grid() const { return grid_; }
  const hbCombinationSparseGrid& combinationGrid() const { return combination_; }
  int component() const { return component_; }

private:
  const hbSparseGrid& grid_;
  const hbCombinationSparseGrid& combination_;
  int component_;
  double semiNodalRoundings_, latticeRoundings_;
};
