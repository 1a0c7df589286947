#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "sparsegrid/hbCombinationSparseGrid.h"

/// What one component grid has at a point, in 64 bits and in field values.
struct hbComponentValue {
  const hbCombinationSparseGrid::Grid* grid = nullptr;
  double value = 0.0; ///< Its trilinear interpolant.
  /// Among the nodes of the point's cell and the cells around it: the greatest magnitude, and how far the greatest is
  /// from the least.
  double largest = 0.0, range = 0.0;
};

namespace hb {

/// Of all component grids, in the order of grids(); `point` is clamped to the cube. 64 nodes a grid.
std::vector<hbComponentValue> componentValues(const hbCombinationSparseGrid& grid, const glm::dvec3& point,
                                              int component = 0);

} // namespace hb
