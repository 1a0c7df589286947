#include "sparsegrid/hbHierarchise.h"

#include <cassert>
#include <vector>

#include "volume/hbParallel.h"

#include "volume/hbError.h"

namespace {

/// All subspaces that differ in the level of one axis only: the lines along that axis through a grid. Seen as arrays,
/// each is [outer][nodes along the axis][inner] with the same outer and inner for every level.
struct LineGroup {
  std::vector<const hbSubspace*> byLevel;
  std::int64_t inner = 1, outer = 1;
};

std::vector<LineGroup> lineGroups(const hbIndexSet& set, int axis) {
  std::vector<LineGroup> groups;
  for (const hbSubspace& first : set.subspaces()) {
    if (first.levels[axis] != 0) continue;
    LineGroup group;
    for (glm::ivec3 l = first.levels; set.contains(l); ++l[axis]) group.byLevel.push_back(&set.subspace(l));
    for (int d = 0; d < axis; ++d) group.inner *= first.nodes[d];
    for (int d = axis + 1; d < 3; ++d) group.outer *= first.nodes[d];
    groups.push_back(std::move(group));
  }
  return groups;
}

/// values(level) += sign * the mean of the two hierarchical neighbours, for all nodes of one level of a group.
/// The nodes (2k+1) 2^-l of level l lie between k 2^-(l-1) and (k+1) 2^-(l-1).
void addNeighbours(const LineGroup& group, int axis, int level, double sign, double* values,
                   const hbProgress& progress) {
  const std::int64_t inner = group.inner;
  const hbSubspace& target = *group.byLevel[std::size_t(level)];
  const std::int64_t nodes = target.nodes[axis];
  const auto row = [&](const hbIndexSet::AxisNode& node, std::int64_t outer) {
    const hbSubspace& subspace = *group.byLevel[std::size_t(node.level)];
    return values + subspace.offset + (outer * subspace.nodes[axis] + node.index) * inner;
  };
  for (std::int64_t outer = 0; outer < group.outer; ++outer) {
    if (progress.cancelled()) throw hbCancelled();
    for (std::int64_t k = 0; k < nodes; ++k) {
      const double* left = row(hbIndexSet::axisNode(false, level - 1, k), outer);
      const double* right = row(hbIndexSet::axisNode(false, level - 1, k + 1), outer);
      double* own = values + target.offset + (outer * nodes + k) * inner;
      for (std::int64_t i = 0; i < inner; ++i) own[i] += sign * (0.5 * (left[i] + right[i]));
    }
  }
}

template <class Sweep>
void forEachGroup(const hbIndexSet& set, int axis, Sweep sweep) {
  if (set.flat()[axis]) return;
  const std::vector<LineGroup> groups = lineGroups(set, axis);
  hb::parallelFor(std::int64_t(groups.size()), [&](std::int64_t g) { sweep(groups[std::size_t(g)]); });
}

} // namespace

void hb::hierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress) {
  assert(std::int64_t(values.size()) == set.storedValues());
  for (int axis = 0; axis < 3; ++axis)
    forEachGroup(set, axis, [&](const LineGroup& group) {
      for (int level = int(group.byLevel.size()) - 1; level >= 1; --level)
        addNeighbours(group, axis, level, -1.0, values.data(), progress);
    });
}

void hb::dehierarchise(const hbIndexSet& set, std::span<double> values, const hbProgress& progress) {
  assert(std::int64_t(values.size()) == set.storedValues());
  for (int axis = 0; axis < 3; ++axis)
    forEachGroup(set, axis, [&](const LineGroup& group) {
      for (int level = 1; level < int(group.byLevel.size()); ++level)
        addNeighbours(group, axis, level, 1.0, values.data(), progress);
    });
}
