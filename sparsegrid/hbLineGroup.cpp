#include "sparsegrid/hbLineGroup.h"

std::vector<hbLineGroup> hb::lineGroups(const hbIndexSet& set, int axis) {
  std::vector<hbLineGroup> groups;
  if (set.flat()[axis]) return groups;
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
