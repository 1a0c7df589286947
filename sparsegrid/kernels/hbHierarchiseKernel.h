#pragma once

#include <array>
#include <cstdint>

#include "sparsegrid/hbIndexSet.h"

/// The lines along one axis through all subspaces that differ in that axis' level only. Seen as arrays, each of these
/// is [outer][nodes along the axis][inner], with the same outer and inner for every level; inner is a power of two.
struct hbLineGroup {
  std::array<std::int64_t, hbIndexSet::kMaxLevel + 1> offset{}; ///< Of level l's array.
  int finest = 0;
  std::int64_t inner = 1, outer = 1;
};

namespace hb {

enum class LineTransform : std::uint8_t { hierarchise, dehierarchise };

/// Transforms the lines first <= outer < last of a group, in place: every node of level l >= 1 minus (plus) the mean of
/// its two neighbours' nodal values. The outcome does not depend on the instruction set.
void transformLines(const hbLineGroup& group, std::int64_t first, std::int64_t last, LineTransform transform,
                    double* values);

} // namespace hb
