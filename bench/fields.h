#pragma once

#include <span>
#include <vector>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbVolumeField.h"

/// What the benchmarks look at, each built at its first use: the hydrogen orbital 3d_z2 in every form.
namespace bench {

/// Random points of the cube, always the same: neighbours in the list are not neighbours in space.
class Points {
public:
  explicit Points(std::size_t count);
  hbPoints view() const { return {x_, y_, z_}; }
  glm::vec3 at(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

private:
  std::vector<float> x_, y_, z_;
};

/// The regular grid of that level, uncapped: the sparse-grid paper's.
const hbSparseGrid& sparseGrid(int level);

/// The same grid, nodal along x.
const hbSemiNodalGrid& semiNodal(int level);

/// The same grid's component grids.
const hbCombinationSparseGrid& combination(int level);

/// Samples on size^3 nodes, 32-bit floats.
const hbVolumeField& volume(int size);

} // namespace bench
