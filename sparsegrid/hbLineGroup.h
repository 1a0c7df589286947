#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sparsegrid/hbIndexSet.h"

/// The lines along one axis through all subspaces that differ in that axis' level only. Seen as arrays, each of these
/// is [outer][nodes along the axis][inner], with the same outer and inner for every level; inner is a power of two.
struct hbLineGroup {
  std::array<std::int64_t, hbIndexSet::kMaxLevel + 1> offset{}; ///< Of level l's array.
  int finest = 0;
  std::int64_t inner = 1, outer = 1;
};

namespace hb {

/// Those of all lines along the axis that have more than level 0; none where it is flat.
std::vector<hbLineGroup> lineGroups(const hbIndexSet& set, int axis);

} // namespace hb
