#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "sparsegrid/hbIndexSet.h"
#include "volume/hbField.h"
#include "volume/hbLatticeMapping.h"

/// Reads a field's values at the nodes of subspaces, under either mapping of samples to the lattice.
///
/// Fitted: a node takes the field's value at its place in the cube. Aligned: lattice node i takes sample i; the nodes
/// outside the volume are continued axis by axis so that their surpluses vanish: the last one, R = 2^n, takes 2 f(m) -
/// f(0) with m = 2^(n-1) (which always lies inside), so that m's surplus vanishes too, and every other one the mean of
/// its neighbours. An axis of N samples thus keeps N surpluses that are not zero.
class hbNodeSampler {
public:
  /// Keeps a reference to `source`.
  hbNodeSampler(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping);

  /// out = the values at the subspace's nodes, x fastest. Throws hbError where one is NaN or infinite. Thread-safe.
  void sample(const hbSubspace& subspace, int component, std::span<double> out) const;

private:
  /// A node's value along one axis as a weighted sum of samples: pairs of sample index and weight.
  using Stencil = std::vector<std::pair<std::int64_t, double>>;
  Stencil stencil(int axis, std::int64_t latticeNode) const;

  /// The nodes of one level of an axis: the coordinates to read, and each node's weights on what was read.
  struct AxisPlan {
    std::vector<double> coordinates;
    std::vector<std::vector<std::pair<std::size_t, double>>> nodes; ///< Empty: node i is coordinate i.
  };
  AxisPlan plan(int axis, int level) const;

  const hbField& source_;
  hbSize3 size_;
  bool aligned_;
  std::array<int, 3> latticeLevel_{};          ///< 2^latticeLevel cells an axis (aligned).
  std::array<std::vector<AxisPlan>, 3> plans_; ///< One a level of each axis.
};
