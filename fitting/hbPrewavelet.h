#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sparsegrid/hbIndexSet.h"

/// One linear prewavelet of an axis, as values at the nodes of its level.
///
/// Products of prewavelets are another basis of a sparse grid's functions. Level 0 has the two hats of the surpluses; a
/// prewavelet of level l >= 1 is a combination of the hats of all 2^l + 1 nodes that is orthogonal to every function of
/// level l-1: [1, -6, 10, -6, 1]/10 around an odd node, [-12, 11, -6, 1]/10 at an end, [-1, 1, -1] of level 1. A level
/// reaches into coarser ones only, so a downward closed set keeps its functions. Scaled by their norms they are stable:
/// however fine the grid, the sum of squares of its coefficients is the squared norm of the function, and so it is for
/// slopes, up to constant factors. Of surpluses that is not so, which makes them a bad and these a good basis to solve
/// in. Source: Chui and Wang, On compactly supported spline wavelets and a duality principle, Transactions of the
/// American Mathematical Society 330 (1992); on sparse grids, Griebel and Oswald, Tensor product type subspace
/// splittings and multilevel iterative methods for anisotropic problems, Advances in Computational Mathematics 4
/// (1995).
struct hbPrewavelet {
  int level = 0;
  std::int64_t first = 0; ///< The first node that has a value.
  std::array<double, 5> values{};
  int count = 0; ///< Of values.

  /// The k-th of a level, 0 <= k < hbIndexSet::axisNodes(flat, level); of a flat axis the constant 1.
  static hbPrewavelet at(bool flat, int level, std::int64_t k);

  /// At a coordinate of [0,1].
  double value(double x) const;
};

namespace hb {

/// T: coefficients of prewavelets, in the order of set.subspaces(), to the surpluses of the same function, in place.
/// O(3 values), threads over the lines.
void prewaveletsToSurpluses(const hbIndexSet& set, std::span<double> values);

/// The transpose of T, in place.
void prewaveletsToSurplusesTransposed(const hbIndexSet& set, std::span<double> values);

} // namespace hb
