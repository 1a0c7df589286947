#pragma once

#include <cstdint>
#include <span>

#include "sparsegrid/hbLatticeBlocks.h"
#include "sparsegrid/hbLatticePlan.h"

/// Evaluates one component of a sparse grid on rectilinear lattices, plane by plane and axis by axis, so that a
/// surplus is touched once a plane and not once a sample.
///
/// For a place along the plane axis the surpluses are summed over that axis' levels into one array for each pair of
/// levels of the other two (a *block*). The row axis is split in two. Its coarse levels are evaluated at the
/// samples of the fast axis first, line by line, and dehierarchised: nodal *coarse rows*, between which a row is one
/// linear interpolation. Beside its fine levels the fast axis is so coarse (at most 16 cells) that their sum at a
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
  explicit hbLatticeEvaluator(const hbSparseGrid& grid, int component, const hbAxisOrder& order = {})
      : blocks_(grid, component, order) {}

  const hbAxisOrder& order() const { return blocks_.order(); }

  /// Prepares planes with samples at us along the fast axis and vs along the row axis, see hbLatticePlanOf.
  template <class Real>
  hbLatticePlanOf<Real> planOf(std::span<const double> us, std::span<const double> vs,
                               Quantity quantity = Quantity::value) const {
    return {blocks_, us, vs, quantity};
  }
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

  /// What plane() needs of the workspace at most for so many samples a row, in bytes.
  double bytes(int size) const;

private:
  template <class Real>
  void sumPlanes(const hbLatticePlanOf<Real>& plan, double w, hbLatticeWorkspaceOf<Real>& workspace) const;
  template <class Real>
  void coarseRows(const hbLatticePlanOf<Real>& plan, hbLatticeWorkspaceOf<Real>& workspace) const;

  hbLatticeBlocks blocks_;
};
