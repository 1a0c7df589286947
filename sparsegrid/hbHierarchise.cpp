#include "sparsegrid/hbHierarchise.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "sparsegrid/kernels/hbHierarchiseKernel.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

/// The lines of all groups, cut into parts of a few thousand nodes.
std::vector<hb::LinePart> partsOf(const std::vector<hbLineGroup>& groups) {
  constexpr std::int64_t kNodes = 8192, kFewestInner = 16;
  std::vector<hb::LinePart> parts;
  for (const hbLineGroup& group : groups) {
    const std::int64_t length = (std::int64_t{1} << group.finest) + 1;
    // Several outer lines a part, or where one of them is too much already, a share of its inner ones.
    const bool wide = group.inner >= hb::kWideRow;
    const std::int64_t inner = wide ? std::min(group.inner, std::max(kFewestInner, kNodes / length)) : group.inner;
    const std::int64_t outer = std::max<std::int64_t>(1, kNodes / (length * inner));
    for (std::int64_t o = 0; o < group.outer; o += outer)
      for (std::int64_t i = 0; i < group.inner; i += inner)
        parts.push_back({&group, o, std::min(o + outer, group.outer), i, std::min(i + inner, group.inner)});
  }
  return parts;
}

void transform(const hbIndexSet& set, hb::LineTransform transform, double* values, const hbProgress& progress) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<hbLineGroup> groups = hb::lineGroups(set, axis);
    const std::vector<hb::LinePart> parts = partsOf(groups);
    hb::parallelFor(std::int64_t(parts.size()), [&](std::int64_t p) {
      if (progress.cancelled()) throw hbCancelled();
      hb::transformLines(parts[std::size_t(p)], transform, values);
    });
  }
}

} // namespace

void hb::hierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress) {
  assert(std::int64_t(values.size()) == set.storedValues());
  transform(set, LineTransform::hierarchise, values.data(), progress);
}

void hb::dehierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress) {
  assert(std::int64_t(values.size()) == set.storedValues());
  transform(set, LineTransform::dehierarchise, values.data(), progress);
}
