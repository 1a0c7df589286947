#include "sparsegrid/hbHierarchise.h"

#include <algorithm>
#include <cassert>
#include <vector>

#include "sparsegrid/kernels/hbHierarchiseKernel.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

std::vector<hbLineGroup> lineGroups(const hbIndexSet& set, int axis) {
  std::vector<hbLineGroup> groups;
  for (const hbSubspace& first : set.subspaces()) {
    if (first.levels[axis] != 0) continue;
    hbLineGroup group;
    group.finest = -1;
    for (glm::ivec3 l = first.levels; set.contains(l); ++l[axis])
      group.offset[std::size_t(++group.finest)] = set.subspace(l).offset;
    for (int d = 0; d < axis; ++d) group.inner *= first.nodes[d];
    for (int d = axis + 1; d < 3; ++d) group.outer *= first.nodes[d];
    if (group.finest > 0) groups.push_back(group);
  }
  return groups;
}

/// Some lines of a group, few enough to be a small part of the work.
struct Task {
  const hbLineGroup* group;
  std::int64_t first, last;
};

std::vector<Task> tasksOf(const std::vector<hbLineGroup>& groups) {
  constexpr std::int64_t kNodes = 8192;
  std::vector<Task> tasks;
  for (const hbLineGroup& group : groups) {
    const std::int64_t nodes = ((std::int64_t{1} << group.finest) + 1) * group.inner;
    const std::int64_t lines = std::max<std::int64_t>(1, kNodes / nodes);
    for (std::int64_t first = 0; first < group.outer; first += lines)
      tasks.push_back({&group, first, std::min(first + lines, group.outer)});
  }
  return tasks;
}

void transform(const hbIndexSet& set, hb::LineTransform transform, double* values, const hbProgress& progress) {
  for (int axis = 0; axis < 3; ++axis) {
    if (set.flat()[axis]) continue;
    const std::vector<hbLineGroup> groups = lineGroups(set, axis);
    const std::vector<Task> tasks = tasksOf(groups);
    hb::parallelFor(std::int64_t(tasks.size()), [&](std::int64_t t) {
      if (progress.cancelled()) throw hbCancelled();
      const auto& [group, first, last] = tasks[std::size_t(t)];
      hb::transformLines(*group, first, last, transform, values);
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
