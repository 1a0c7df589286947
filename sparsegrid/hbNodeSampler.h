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
  /// Keeps a reference to `source`. Throws hbError where checkAligned() does.
  hbNodeSampler(const hbField& source, const hbIndexSet& set, hbLatticeMapping mapping);

  /// out = the values at the subspace's nodes with z index first <= k < first + count, x fastest. Throws hbError where
  /// one is NaN or infinite. Thread-safe. Needs about 20 bytes a value for a while.
  void sample(const hbSubspace& subspace, std::int64_t first, std::int64_t count, int component,
              std::span<double> out) const;

  /// The least n with 2^n >= size-1: how fine the aligned mapping's lattice is along an axis.
  static int alignedLevel(std::int64_t size);

  /// Throws hbError unless a set can be aligned with `size` samples: no axis finer than alignedLevel(), nor too long.
  static void checkAligned(const hbSize3& size, const hbIndexSet& set);

private:
  /// A node's value along one axis as a weighted sum of samples: pairs of sample index and weight.
  using Stencil = std::vector<std::pair<std::int64_t, double>>;
  Stencil stencil(int axis, std::int64_t latticeNode) const;

  /// Consecutive nodes of one level of an axis: the coordinates to read, and each node's weights on what was read.
  struct AxisPlan {
    std::vector<double> coordinates;
    std::vector<std::vector<std::pair<std::size_t, double>>> nodes; ///< Empty: node i is coordinate i.
  };
  AxisPlan plan(int axis, int level, std::int64_t first, std::int64_t count) const;
  AxisPlan plan(int axis, int level) const;

  const hbField& source_;
  hbSize3 size_;
  bool aligned_;
  std::array<std::vector<AxisPlan>, 2> plans_; ///< Whole levels of x and y; those of z are made for each slab.
};
