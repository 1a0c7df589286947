#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sparsegrid/hbIndexSet.h"

namespace hb {

/// Copies the nodes of the component grid of those levels, x fastest, out of the values at all nodes of a sparse grid
/// (hbSparseGrid::nodalValues()), which holds them. `out` takes one for each.
template <class Real>
void copyComponentNodes(const hbIndexSet& set, std::span<const double> nodal, const glm::ivec3& levels, Real* out) {
  std::array<std::vector<hbIndexSet::AxisNode>, 3> axes;
  for (int d = 0; d < 3; ++d) {
    const std::int64_t nodes = set.flat()[d] ? 1 : (std::int64_t{1} << levels[d]) + 1;
    for (std::int64_t k = 0; k < nodes; ++k)
      axes[std::size_t(d)].push_back(hbIndexSet::axisNode(set.flat()[d], levels[d], k));
  }
  for (const auto [lz, iz] : axes[2])
    for (const auto [ly, iy] : axes[1])
      for (const auto [lx, ix] : axes[0]) {
        const hbSubspace& from = set.subspace({lx, ly, lz});
        *out++ = Real(nodal[std::size_t(from.offset + ix + from.nodes.x * (iy + from.nodes.y * iz))]);
      }
}

} // namespace hb
