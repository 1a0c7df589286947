#pragma once

#include <cmath>

#include "tests/sparsegrid/hbTestSets.h"

/// How far what hbOglValues evaluates may be from exact values.
namespace hbOglValuesBounds {

/// At one point in 32 bits. As the combination engine's (hbTestSets::combinationBound), but that additions are in 32
/// bits, too, each of a partial sum up to the sum of the coefficients.
inline double combination(const hbSparseGrid& grid, int component = 0) {
  double coefficients = 0.0, largest = 0.0;
  for (const auto& one : grid.indexSet().componentGrids()) coefficients += std::abs(one.coefficient);
  for (const double value : grid.nodalValues(component)) largest = std::max(largest, std::abs(value));
  return hbTestSets::combinationBound(grid.indexSet(), largest) +
         double(grid.indexSet().componentGrids().size()) * 0x1p-24 * coefficients * largest +
         hbTestSets::coordinateBound(grid, component);
}

/// As the semi-nodal engine's (hbTestSets::semiNodalBound), but that 1 - |kind t - ...| is rounded absolutely, by
/// 2^-25, which the four terms of a base grid sum up (2 roundings more), and that the step along x is a + t (b - a),
/// which takes 5 roundings (see there) instead of 3.
inline double semiNodal(const hbSparseGrid& grid, int component = 0) {
  return hbTestSets::semiNodalBound(grid, component) + 4.0 * 0x1p-24 * hbTestSets::amplitude(grid, component);
}

/// The greatest slopes there may be along the axes of the cube: of a subspace, 2^l times its largest surplus; of level
/// 0, the difference of two.
inline glm::dvec3 slopes(const hbSparseGrid& grid, int component = 0) {
  glm::dvec3 sum(0.0);
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) {
    double largest = 0.0;
    for (const float s : grid.surpluses(subspace, component)) largest = std::max(largest, double(std::abs(s)));
    for (int d = 0; d < 3; ++d)
      if (!grid.indexSet().flat()[d])
        sum[d] += std::exp2(std::max(subspace.levels[d], 1)) * largest * grid.latticeScale()[d];
  }
  return sum;
}

} // namespace hbOglValuesBounds
