#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/vector_relational.hpp>
#include <rapidcheck.h>

#include "sparsegrid/hbIndexSet.h"

/// Random index sets that the tests of sparse grids share.
namespace hbTestSets {

/// Axes with any mixture of flat, two-node and refined ones up to level 5.
inline rc::Gen<hbIndexSet::Axes> axes() {
  return rc::gen::map(rc::gen::container<std::vector<int>>(3, rc::gen::inRange(-1, 6)),
                      [](const std::vector<int>& kinds) {
                        hbIndexSet::Axes axes;
                        for (int d = 0; d < 3; ++d) {
                          axes.flat[d] = kinds[std::size_t(d)] < 0;
                          axes.maxLevel[d] = std::max(kinds[std::size_t(d)], 0);
                        }
                        return axes;
                      });
}

/// A regular, capped, anisotropic or full set.
inline rc::Gen<hbIndexSet> any() {
  return rc::gen::map(
      rc::gen::pair(axes(), rc::gen::inRange(0, 8)), [](const std::pair<hbIndexSet::Axes, int>& choice) {
        return choice.second == 0 ? hbIndexSet::full(choice.first) : hbIndexSet::regular(choice.second, choice.first);
      });
}

/// The size of a volume whose lattice the set's axes are: 1 where flat, 2 where coarse, 2^l + 1.
inline hbSize3 sizeOf(const hbIndexSet& set) {
  hbSize3 size;
  for (int d = 0; d < 3; ++d) size[d] = set.flat()[d] ? 1 : (std::int64_t{1} << set.finest()[d]) + 1;
  return size;
}

} // namespace hbTestSets
