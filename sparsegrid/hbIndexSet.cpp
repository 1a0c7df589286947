#include "sparsegrid/hbIndexSet.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "volume/hbError.h"

namespace {

/// The number of the level a subspace belongs to.
int levelNumber(const glm::ivec3& levels) {
  return std::max(levels.x, 1) + std::max(levels.y, 1) + std::max(levels.z, 1) - 2;
}

/// All indices with levels up to `maxLevel` that `keep` accepts.
template <class Keep>
std::vector<glm::ivec3> collect(const glm::ivec3& maxLevel, Keep keep) {
  std::vector<glm::ivec3> levels;
  for (int z = 0; z <= maxLevel.z; ++z)
    for (int y = 0; y <= maxLevel.y; ++y)
      for (int x = 0; x <= maxLevel.x; ++x)
        if (keep(glm::ivec3(x, y, z))) levels.emplace_back(x, y, z);
  return levels;
}

void checkLevel(int n) {
  if (n < 1 || n > hbIndexSet::kMaxLevel)
    throw hbError(fmt::format("level: expected 1 to {}, found {}", hbIndexSet::kMaxLevel, n));
}

int resolvingLevel(std::int64_t size) {
  int level = 0;
  while ((std::int64_t{1} << level) < size - 1) ++level;
  return level;
}

} // namespace

std::int64_t hbIndexSet::axisNodes(bool flat, int level) {
  if (flat) return 1;
  return level == 0 ? 2 : std::int64_t{1} << (level - 1);
}

hbIndexSet::AxisNode hbIndexSet::axisNode(bool flat, int level, std::int64_t k) {
  if (flat || k == 0) return {0, 0};
  if (k == std::int64_t{1} << level) return {0, 1};
  const int zeros = std::countr_zero(std::uint64_t(k));
  return {level - zeros, k >> (zeros + 1)};
}

hbIndexSet::Axes hbIndexSet::axesOf(const hbSize3& size) {
  Axes axes;
  for (int d = 0; d < 3; ++d) {
    axes.flat[d] = size[d] == 1;
    axes.maxLevel[d] = std::min(resolvingLevel(size[d]), kMaxLevel);
  }
  return axes;
}

hbIndexSet::Axes hbIndexSet::uncappedAxesOf(const hbSize3& size) {
  Axes axes;
  for (int d = 0; d < 3; ++d) {
    axes.flat[d] = size[d] == 1;
    axes.maxLevel[d] = size[d] <= 2 ? 0 : kMaxLevel;
  }
  return axes;
}

hbIndexSet hbIndexSet::regular(int n, const Axes& axes) {
  checkLevel(n);
  const glm::ivec3 bound = glm::min(axes.maxLevel, glm::ivec3(n));
  return {collect(bound, [n](const glm::ivec3& l) { return levelNumber(l) <= n; }), axes.flat};
}

hbIndexSet hbIndexSet::anisotropic(const glm::ivec3& levels, const Axes& axes) {
  for (int d = 0; d < 3; ++d) checkLevel(levels[d]);
  // Levels above 1, in units in which each axis may have `limit` of them: whole numbers throughout. Where an axis has
  // none, it stays within its bound and counts for nothing.
  const glm::ivec3 most = glm::max(levels - 1, 1);
  const int limit = most.x * most.y * most.z;
  return {collect(glm::min(axes.maxLevel, levels),
                  [&](const glm::ivec3& l) {
                    const glm::ivec3 fine = glm::max(l, 1) - 1;
                    return fine.x * (limit / most.x) + fine.y * (limit / most.y) + fine.z * (limit / most.z) <= limit;
                  }),
          axes.flat};
}

hbIndexSet hbIndexSet::full(const Axes& axes) {
  return {collect(axes.maxLevel, [](const glm::ivec3&) { return true; }), axes.flat};
}

hbIndexSet hbIndexSet::fromList(const std::vector<glm::ivec3>& levels, const glm::bvec3& flat,
                                const std::string& what) {
  if (levels.empty()) throw hbError(fmt::format("{}: expected at least one subspace, found none", what));
  for (const glm::ivec3& l : levels)
    for (int d = 0; d < 3; ++d)
      if (l[d] < 0 || l[d] > (flat[d] ? 0 : kMaxLevel))
        throw hbError(fmt::format("{}: expected levels from 0 to {} along {}, found {}", what, flat[d] ? 0 : kMaxLevel,
                                  "xyz"[d], l[d]));
  const hbIndexSet set(levels, flat, what);
  if (set.subspaces_.size() != levels.size()) throw hbError(fmt::format("{}: expected each subspace once", what));
  for (const glm::ivec3& l : levels)
    for (int d = 0; d < 3; ++d) {
      // Closed downwards, and level 0 and 1 of an axis come together.
      glm::ivec3 other = l;
      other[d] = l[d] > 0 ? l[d] - 1 : set.finest_[d] > 0 ? 1 : 0;
      if (!set.contains(other))
        throw hbError(
            fmt::format("{}: expected ({},{},{}) beside ({},{},{})", what, other.x, other.y, other.z, l.x, l.y, l.z));
    }
  return set;
}

hbIndexSet hbIndexSet::enclosing(const std::vector<glm::ivec3>& indices, const glm::bvec3& flat,
                                 const std::string& what) {
  glm::ivec3 finest(-1);
  for (const glm::ivec3& index : indices) finest = glm::max(finest, index);
  // One level beyond the last is enough for fromList() to say which one is too fine.
  return fromList(collect(glm::min(finest, glm::ivec3(kMaxLevel + 1)),
                          [&](const glm::ivec3& l) {
                            return std::any_of(indices.begin(), indices.end(), [&](const glm::ivec3& index) {
                              return glm::all(glm::lessThanEqual(l, index));
                            });
                          }),
                  flat, what);
}

hbIndexSet::hbIndexSet(const std::vector<glm::ivec3>& levels, const glm::bvec3& flat, const std::string& what)
    : flat_(flat) {
  for (const glm::ivec3& l : levels) finest_ = glm::max(finest_, l);
  std::vector<glm::ivec3> ordered = levels;
  const auto key = [](const glm::ivec3& l) { return std::tuple(levelNumber(l), l.z, l.y, l.x); };
  std::sort(ordered.begin(), ordered.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  ordered.erase(std::unique(ordered.begin(), ordered.end()), ordered.end());

  place_.assign(std::size_t((finest_.x + 1) * (finest_.y + 1) * (finest_.z + 1)), -1);
  for (const glm::ivec3& l : ordered) {
    hbSubspace subspace;
    subspace.levels = l;
    subspace.offset = storedValues_;
    for (int d = 0; d < 3; ++d) subspace.nodes[d] = axisNodes(flat[d], l[d]);
    // At most 2^57 for one subspace and kMaxLevel; a set of them could overflow.
    if (__builtin_add_overflow(storedValues_, subspace.count(), &storedValues_) ||
        storedValues_ > (std::int64_t{1} << 60))
      throw hbError(fmt::format("{}: expected fewer than 2^60 values in all", what));
    place_[slot(l)] = int(subspaces_.size());
    subspaces_.push_back(subspace);
  }
}

std::size_t hbIndexSet::slot(const glm::ivec3& l) const {
  return std::size_t(l.x + (finest_.x + 1) * (l.y + (finest_.y + 1) * l.z));
}

bool hbIndexSet::contains(const glm::ivec3& l) const {
  for (int d = 0; d < 3; ++d)
    if (l[d] < 0 || l[d] > finest_[d]) return false;
  return place_[slot(l)] >= 0;
}

const hbSubspace& hbIndexSet::subspace(const glm::ivec3& l) const {
  assert(contains(l));
  return subspaces_[std::size_t(place_[slot(l)])];
}

int hbIndexSet::number() const { return levelNumber(subspaces_.back().levels); }

std::vector<hbLevel> hbIndexSet::levels() const {
  std::vector<hbLevel> list;
  for (const hbSubspace& subspace : subspaces_) {
    const int number = levelNumber(subspace.levels);
    if (list.empty() || list.back().number != number) list.push_back({number, {}});
    list.back().subspaces.push_back(subspace);
  }
  return list;
}

std::vector<hbIndexSet::ComponentGrid> hbIndexSet::componentGrids() const {
  std::vector<ComponentGrid> grids;
  for (const hbSubspace& subspace : subspaces_) {
    const glm::ivec3 l = subspace.levels;
    // Level 0 of a refined axis is part of every component grid; a coarse axis has nothing to difference.
    bool grid = true;
    glm::ivec3 last(1);
    for (int d = 0; d < 3; ++d) {
      if (finest_[d] == 0)
        last[d] = 0;
      else if (l[d] == 0)
        grid = false;
    }
    if (!grid) continue;
    int coefficient = 0;
    for (int z = 0; z <= last.z; ++z)
      for (int y = 0; y <= last.y; ++y)
        for (int x = 0; x <= last.x; ++x)
          if (contains(l + glm::ivec3(x, y, z))) coefficient += (x + y + z) % 2 == 0 ? 1 : -1;
    if (coefficient == 0) continue;
    ComponentGrid component{l, coefficient, {}};
    for (int d = 0; d < 3; ++d) component.nodes[d] = flat_[d] ? 1 : (std::int64_t{1} << l[d]) + 1;
    grids.push_back(component);
  }
  return grids;
}

std::int64_t hbIndexSet::combinationValues() const {
  std::int64_t sum = 0;
  for (const ComponentGrid& grid : componentGrids()) sum += grid.nodes.x * grid.nodes.y * grid.nodes.z;
  return sum;
}

std::int64_t hbIndexSet::paddedTexels() const {
  std::int64_t sum = 0;
  for (const ComponentGrid& grid : componentGrids()) {
    std::int64_t texels = 1;
    for (int d = 0; d < 3; ++d) texels *= flat_[d] ? 1 : std::int64_t{2} << grid.levels[d];
    sum += texels;
  }
  return sum;
}
