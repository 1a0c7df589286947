#include "sparsegrid/hbLatticeBlocks.h"

#include <cmath>

#include "sparsegrid/kernels/hbLatticeKernel.h"

hbLatticeBlocks::hbLatticeBlocks(const hbSparseGrid& grid, int component, const hbAxisOrder& order)
    : grid_(grid), order_(order) {
  const hbIndexSet& set = grid.indexSet();
  if (order != hbAxisOrder{}) reorder(component);
  // Reordered subspaces lie as they do in the grid.
  const float* surpluses = order == hbAxisOrder{} ? grid.surpluses(component).data() : reordered_.data();
  for (int row = 0; set.contains(order.inCube(0, row, 0)); ++row) {
    besideRow_.emplace_back();
    for (int fast = 0; set.contains(order.inCube(fast, row, 0)); ++fast) {
      const hbSubspace& base = set.subspace(order.inCube(fast, row, 0));
      Block block{base.nodes[order.fast], base.nodes[order.row], {}};
      for (int plane = 0; set.contains(order.inCube(fast, row, plane)); ++plane)
        block.byLevel.push_back(surpluses + set.subspace(order.inCube(fast, row, plane)).offset);
      besideRow_.back().push_back(blocks_.size());
      blocks_.push_back(std::move(block));
    }
    if (int(besideRow_.back().size()) > hbLatticeTableParts::kTableLevel + 1) split_ = row + 1;
  }
}

double hbLatticeBlocks::place(double coordinate, int axis) const {
  if (grid_.frame().mapping == hbLatticeMapping::fitted || flat(axis)) return grid_.latticeCoordinate(coordinate, axis);
  const double cells = double(grid_.geometry().size[axis] - 1);
  const double sample = std::nearbyint(coordinate * cells);
  const bool isSample = std::abs(coordinate * cells - sample) <= 0x1p-52 * cells;
  return isSample && sample >= 0.0 && sample <= cells ? sample * (grid_.latticeScale()[axis] / cells)
                                                      : grid_.latticeCoordinate(coordinate, axis);
}

void hbLatticeBlocks::reorder(int component) {
  const auto from = grid_.surpluses(component);
  reordered_.resize(from.size());
  for (const hbSubspace& subspace : grid_.indexSet().subspaces()) {
    const hbSize3 nodes = subspace.nodes;
    const std::int64_t strides[] = {1, nodes.x, nodes.x * nodes.y};
    float* to = reordered_.data() + subspace.offset;
    for (std::int64_t k = 0; k < nodes[order_.plane]; ++k)
      for (std::int64_t j = 0; j < nodes[order_.row]; ++j)
        for (std::int64_t i = 0; i < nodes[order_.fast]; ++i)
          *to++ = from[std::size_t(subspace.offset + i * strides[order_.fast] + j * strides[order_.row] +
                                   k * strides[order_.plane])];
  }
}
