#pragma once

#include <span>

#include "sparsegrid/hbIndexSet.h"
#include "volume/hbProgress.h"

namespace hb {

/// Turns the values at a sparse grid's nodes into its surpluses, in place; `values` runs over the whole index set.
///
/// Axis by axis over whole arrays: along one axis the surplus of a node is its value minus the mean of its two
/// hierarchical neighbours, the stencil [-1/2, 1, -1/2] with the neighbours still nodal, so finer levels go first;
/// level 0 keeps its values. Source: the sparse-grid paper, section 2. O(3 values), threads over the lines' groups; the
/// outcome does not depend on their number. NaN and infinity spread to the node's descendants. Throws
/// hbCancelled soon after `progress` was cancelled.
void hierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress = hbProgress::none());

/// The inverse: surpluses to nodal values, coarser levels first.
void dehierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress = hbProgress::none());

} // namespace hb
