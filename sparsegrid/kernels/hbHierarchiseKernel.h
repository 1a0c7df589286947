#pragma once

#include <cstdint>

#include "sparsegrid/hbLineGroup.h"

namespace hb {

enum class LineTransform : std::uint8_t { hierarchise, dehierarchise };

/// Some lines of a group: first <= outer < last, and of each of these firstInner <= inner < lastInner, which must be
/// all of them where the group's inner is below kWideRow.
struct LinePart {
  const hbLineGroup* group = nullptr;
  std::int64_t first = 0, last = 0, firstInner = 0, lastInner = 0;
};
constexpr std::int64_t kWideRow = 8;

/// Transforms these lines in place: every node of level l >= 1 minus (plus) the mean of its two neighbours' nodal
/// values. The outcome does not depend on the instruction set.
void transformLines(const LinePart& part, LineTransform transform, double* values);

} // namespace hb
