#pragma once

#include <algorithm>
#include <cstdint>

#include "sparsegrid/hbIndexSet.h"

/// What the hat functions of one axis are at one coordinate: for every level the node whose hat is not zero there.
///
/// Slot 0 and 1 are the two nodes of level 0 with the weights 1-u and u (on a flat axis slot 0 alone, weight 1); slot
/// l+1 is the node of level l >= 1, equations (2) of the sparse-grid paper: w = 1 - |t|, t = u 2^l - (2k+1) in [-1,1].
/// Slopes are one-sided towards + (the box function), at u = 1 towards -.
template <class Real>
struct hbHat {
  static constexpr int kSlots = hbIndexSet::kMaxLevel + 2;
  std::int32_t node[kSlots];
  Real weight[kSlots];
  Real slope[kSlots];

  /// u is clamped to [0,1], NaN counts as 0; fills the slots up to `finest`'s.
  void evaluate(Real u, bool flat, int finest) {
    u = u > Real(0) ? std::min(u, Real(1)) : Real(0);
    node[0] = 0;
    node[1] = 1;
    weight[0] = flat ? Real(1) : Real(1) - u;
    weight[1] = flat ? Real(0) : u;
    slope[0] = flat ? Real(0) : Real(-1);
    slope[1] = flat ? Real(0) : Real(1);
    if (finest == 0) return;
    // The nodes nest: a coarser level's is the finest one's, halved.
    const std::int32_t finestNodes = std::int32_t{1} << (finest - 1);
    const std::int32_t last = std::min(std::int32_t(u * Real(finestNodes)), finestNodes - 1);
    Real scale = Real(1);
    for (int level = 1; level <= finest; ++level) {
      scale *= Real(2);
      const std::int32_t k = last >> (finest - level);
      const Real t = u * scale - Real(2 * k + 1); // exact: u has no more bits than Real
      node[level + 1] = k;
      weight[level + 1] = t >= Real(0) ? Real(1) - t : Real(1) + t;
      slope[level + 1] = t >= Real(0) ? -scale : scale;
    }
  }
};
