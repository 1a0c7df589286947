#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sparsegrid/hbAxisOrder.h"
#include "sparsegrid/hbLatticePlan.h"
#include "sparsegrid/hbSparseGrid.h"

/// Evaluates one component of a sparse grid on rectilinear lattices, plane by plane and axis by axis, so that a
/// surplus is touched once a plane and not once a sample.
///
/// For a place along the plane axis the surpluses are summed over that axis' levels into one array for each pair of
/// levels of the other two (a *block*). The row axis is split in two. Its coarse levels are evaluated at the
/// samples of the fast axis first, line by line, and dehierarchised: nodal *coarse rows*, between which a row is one
/// linear interpolation. Beside its fine levels the fast axis is so coarse (at most 32 cells) that their sum at a
/// row is a small table, looked up for every sample. A sample so costs a step between two coarse rows and one within a
/// cell of the table, whatever the level of the grid.
///
/// In 64 bits up to the coarse rows and tables, which are rounded to `Real`; doc/sparse-grids.md derives the bound.
/// The split depends on the grid alone: the same sample has the same bits in every lattice evaluated in the same axis
/// order with the samples along the fast axis either adjacent nodes of one level in both, or not in both.
class hbLatticeEvaluator {
public:
  using Quantity = hbLatticeQuantity;

  /// Keeps a reference to `grid`; for any order but the natural one (x, y, z) a reordered copy of the component, 4
  /// bytes a stored value.
  hbLatticeEvaluator(const hbSparseGrid& grid, int component, const hbAxisOrder& order = {});

  const hbAxisOrder& order() const { return order_; }

  /// The order that takes least time, as far as can be told beforehand, for a lattice of so many samples whose x axis
  /// lies fastest in memory. Any other than the natural one must save half of its time.
  static hbAxisOrder cheapestOrder(const hbIndexSet& set, const hbSize3& samples);

  /// Prepares planes with samples at us along the fast axis and vs along the row axis: coordinates of the cube,
  /// increasing; clamped to it (NaN to 0). O((us + vs) levels).
  template <class Real>
  hbLatticePlanOf<Real> planOf(std::span<const double> us, std::span<const double> vs,
                               Quantity quantity = Quantity::value) const;
  hbLatticePlan plan(std::span<const double> us, std::span<const double> vs,
                     Quantity quantity = Quantity::value) const {
    return planOf<float>(us, vs, quantity);
  }

  /// out[i + strideRow j] = the value (or slope) at us[i], vs[j] and w along the plane's axis; `pastCaches`: for planes
  /// that will not be read soon. Threads may share the evaluator and the plan, not the workspace. `Real` is float or
  /// double. O(samples) and O(surpluses) whose hats meet the plane.
  template <class Real>
  void plane(const hbLatticePlanOf<Real>& plan, double w, hbLatticeWorkspaceOf<Real>& workspace, Real* out,
             std::size_t strideRow, bool pastCaches = false) const;

private:
  /// One pair of levels of the fast and the row axis, with all levels of the plane axis beside it.
  struct Block {
    std::int64_t nodesFast = 0, nodesRow = 0;
    std::vector<const float*> byLevel; ///< Arrays [plane][row][fast].
  };

  void reorder(int component);
  bool flat(int axis) const { return grid_.indexSet().flat()[axis]; }
  /// The lattice coordinate of a cube coordinate. With the aligned mapping samples are nodes, to which what
  /// the rounding of k / (N-1) alone put aside is put back.
  double place(double coordinate, int axis) const;

  template <class Real>
  void addWindow(hbLatticePlanOf<Real>& plan, std::size_t block, std::int64_t firstRow, std::int64_t rows,
                 std::int64_t first, std::int64_t count) const;
  template <class Real>
  void addCoarse(hbLatticePlanOf<Real>& plan, int level) const;
  template <class Real>
  void addFine(hbLatticePlanOf<Real>& plan, int begin) const;
  template <class Real>
  void placeAlongFast(hbLatticePlanOf<Real>& plan, const std::vector<double>& places) const;
  template <class Real>
  void placeAlongRow(hbLatticePlanOf<Real>& plan, const std::vector<double>& places) const;

  template <class Real>
  void sumPlanes(const hbLatticePlanOf<Real>& plan, double w, hbLatticeWorkspaceOf<Real>& workspace) const;
  template <class Real>
  void coarseRows(const hbLatticePlanOf<Real>& plan, hbLatticeWorkspaceOf<Real>& workspace) const;

  const hbSparseGrid& grid_;
  hbAxisOrder order_;
  std::vector<float> reordered_;
  std::vector<std::vector<std::size_t>> blockAt_; ///< [level of row][level of fast]
  std::vector<Block> blocks_;
  int split_ = 1; ///< The first level of the row axis in the fine part.
};
