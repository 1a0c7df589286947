#pragma once

#include <cstdint>
#include <span>

#include "sparsegrid/hbAxisOrder.h"
#include "sparsegrid/hbLatticePlan.h"
#include "sparsegrid/hbSparseGrid.h"

/// Evaluates one component of a sparse grid on rectilinear lattices, plane by plane.
class hbLatticeEvaluator {
public:
  /// What is evaluated: the value, or its slope along one of the parts' axes, in field values per unit of the cube.
  enum class Quantity : std::uint8_t { value, slopeFast, slopeRow, slopePlane };

  /// Keeps a reference to `grid`.
  hbLatticeEvaluator(const hbSparseGrid& grid, int component, const hbAxisOrder& order = {});

  const hbAxisOrder& order() const { return order_; }

  /// Prepares planes with samples at us along the fast axis and vs along the row axis: coordinates of the cube,
  /// increasing; clamped to it (NaN to 0).
  hbLatticePlan plan(std::span<const double> us, std::span<const double> vs) const;

  /// out[i + strideRow j] = the value (or slope) at us[i], vs[j] and w along the plane's axis. Threads may share the
  /// evaluator and the plan, not the workspace.
  template <class Real>
  void plane(const hbLatticePlan& plan, double w, hbLatticeWorkspace& workspace, Real* out, std::size_t strideRow,
             Quantity quantity = Quantity::value) const;

private:
  const hbSparseGrid& grid_;
  int component_;
  hbAxisOrder order_;
};
