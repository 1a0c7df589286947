#pragma once

#include <cstdint>
#include <vector>

#include "sparsegrid/hbAxisOrder.h"
#include "sparsegrid/hbSparseGrid.h"

/// One component of a sparse grid as lattices are evaluated from it: in an order of axes, and in *blocks*, each of
/// which has all levels of the plane axis beside one pair of levels of the fast and the row axis.
class hbLatticeBlocks {
public:
  struct Block {
    std::int64_t nodesFast = 0, nodesRow = 0;
    std::vector<const float*> byLevel; ///< By level of the plane axis: surpluses [plane][row][fast].
  };

  /// Keeps a reference to `grid`; for any order but the natural one (x, y, z) a reordered copy of the component, 4
  /// bytes a stored value.
  hbLatticeBlocks(const hbSparseGrid& grid, int component, const hbAxisOrder& order);

  const hbSparseGrid& grid() const { return grid_; }
  const hbAxisOrder& order() const { return order_; }
  const Block& block(std::size_t index) const { return blocks_[index]; }
  /// The indices of the blocks beside one level of the row axis, by level of the fast axis from 0 on.
  const std::vector<std::size_t>& besideRow(std::size_t level) const { return besideRow_[level]; }
  /// The first level of the row axis beside which the fast axis is so coarse, and stays so, that rows are made from
  /// tables (hbLatticeTableParts::kTableLevel); at least 1.
  int split() const { return split_; }

  bool flat(int axis) const { return grid_.indexSet().flat()[axis]; }
  /// The lattice coordinate of a cube coordinate. With the aligned mapping samples are nodes, to which what
  /// the rounding of k / (N-1) alone put aside is put back.
  double place(double coordinate, int axis) const;

private:
  void reorder(int component);

  const hbSparseGrid& grid_;
  hbAxisOrder order_;
  std::vector<float> reordered_;
  std::vector<Block> blocks_;
  std::vector<std::vector<std::size_t>> besideRow_;
  int split_ = 1;
};
