#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <rapidcheck.h>

#include "sparsegrid/hbIndexSet.h"

/// Random index sets that the tests of sparse grids share.
namespace hbTestSets {

/// A whole number from `least` to `most`, each as likely as any other from the first case on. (RapidCheck's own ranges
/// begin with their least number, which makes most sets a point.)
inline rc::Gen<int> number(int least, int most) {
  return rc::gen::resize(rc::kNominalSize, rc::gen::inRange(least, most + 1));
}

/// Axes with any mixture of flat, two-node and refined ones up to level 5.
inline rc::Gen<hbIndexSet::Axes> axes() {
  return rc::gen::map(rc::gen::container<std::vector<int>>(3, number(-1, 5)), [](const std::vector<int>& kinds) {
    hbIndexSet::Axes axes;
    for (int d = 0; d < 3; ++d) {
      axes.flat[d] = kinds[std::size_t(d)] < 0;
      axes.maxLevel[d] = std::max(kinds[std::size_t(d)], 0);
    }
    return axes;
  });
}

/// Whatever four random indices enclose: closed downwards, and nothing else.
inline rc::Gen<hbIndexSet> closed() {
  const auto index = rc::gen::tuple(number(1, 5), number(1, 5), number(1, 5));
  const auto indices = rc::gen::container<std::vector<std::tuple<int, int, int>>>(4, index);
  return rc::gen::map(rc::gen::pair(axes(), indices), [](const auto& choice) {
    const auto& [within, corners] = choice;
    std::vector<glm::ivec3> list;
    for (const auto& [x, y, z] : corners) list.push_back(glm::min(within.maxLevel, glm::ivec3(x, y, z)));
    return hbIndexSet::enclosing(list, within.flat, "closed");
  });
}

/// One of those, for pictures: neither regular nor anisotropic, level 3 on all axes, and unlike in each of their
/// orders.
inline hbIndexSet uneven() {
  return hbIndexSet::enclosing({{3, 2, 1}, {1, 3, 1}, {1, 1, 3}, {2, 1, 2}}, glm::bvec3(false), "uneven");
}

/// A full set, a regular or anisotropic one, capped by its axes, or any that is closed downwards.
inline rc::Gen<hbIndexSet> any() {
  const auto levels = rc::gen::tuple(number(1, 7), number(1, 7), number(1, 7));
  const auto regular = rc::gen::map(rc::gen::pair(axes(), number(1, 7)), [](const auto& choice) {
    return hbIndexSet::regular(choice.second, choice.first);
  });
  const auto anisotropic = rc::gen::map(rc::gen::pair(axes(), levels), [](const auto& choice) {
    const auto& [x, y, z] = choice.second;
    return hbIndexSet::anisotropic({x, y, z}, choice.first);
  });
  return rc::gen::oneOf(rc::gen::map(axes(), hbIndexSet::full), regular, anisotropic, closed());
}

/// The size of a volume whose lattice the set's axes are: 1 where flat, 2 where coarse, 2^l + 1.
inline hbSize3 sizeOf(const hbIndexSet& set) {
  hbSize3 size;
  for (int d = 0; d < 3; ++d) size[d] = set.flat()[d] ? 1 : (std::int64_t{1} << set.finest()[d]) + 1;
  return size;
}

} // namespace hbTestSets
