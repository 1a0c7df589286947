#include "fitting/hbSurplusBlocks.h"

#include <algorithm>

namespace {

/// Of an axis whose level, in a group, is 1.
int slotsOf(bool flat, int finest) { return flat ? 1 : finest == 0 ? 2 : 3; }

} // namespace

glm::ivec3 hbSurplusBlocks::Group::levelsOf(int surplus) const {
  const glm::ivec3 slot(surplus % slots.x, surplus / slots.x % slots.y, surplus / (slots.x * slots.y));
  glm::ivec3 result = levels;
  for (int d = 0; d < 3; ++d)
    if (slot[d] < 2 && levels[d] == 1) result[d] = 0;
  return result;
}

hbSurplusBlocks::hbSurplusBlocks(const hbFitSamples& samples, const hbIndexSet& set, std::int64_t edge)
    : samples_(samples), set_(set), edge_(edge) {
  std::int64_t offset = 0;
  for (const hbSubspace& s : set.subspaces()) {
    Group group;
    bool first = true; // the subspace that stands for the block's others
    for (int d = 0; d < 3; ++d) {
      group.levels[d] = std::max(s.levels[d], 1);
      if (s.levels[d] >= 2)
        group.nodes[d] = s.nodes[d];
      else
        group.slots[d] = slotsOf(set.flat()[d], set.finest()[d]);
      first = first && (s.levels[d] > 0 || set.finest()[d] == 0);
    }
    if (!first) continue;
    group.offset = offset;
    offset += group.blocks() * group.surpluses();
    groups_.push_back(group);
  }
  for (int d = 0; d < 3; ++d) findNodes(d);
}

void hbSurplusBlocks::findNodes(int axis) {
  const std::span<const double> coordinates = samples_.coordinates(axis);
  const int finest = set_.finest()[axis];
  auto& hats = hats_[std::size_t(axis)];
  hats.resize(coordinates.size());
  for (std::size_t i = 0; i < hats.size(); ++i) hats[i].evaluate(coordinates[i], set_.flat()[axis], finest);

  const auto count = std::int64_t(coordinates.size());
  tiles_[axis] = (count + edge_ - 1) / edge_;
  auto& nodes = nodes_[std::size_t(axis)];
  nodes.resize(std::size_t(tiles_[axis] * (finest + 2)));
  for (std::int64_t tile = 0; tile < tiles_[axis]; ++tile) {
    const auto at = nodes.begin() + tile * (finest + 2);
    at[1] = {0};
    for (int level = 2; level <= finest; ++level)
      for (std::int64_t i = tile * edge_; i < std::min(count, (tile + 1) * edge_); ++i) {
        const hbHat<double>& hat = hats[std::size_t(i)];
        const std::int64_t node = hat.node[level + 1];
        if (hat.weight[level + 1] != 0.0 && (at[level].empty() || at[level].back() != node)) at[level].push_back(node);
      }
  }
}

std::vector<std::int64_t> hbSurplusBlocks::order() const {
  std::vector<std::int64_t> result(std::size_t(set_.storedValues()));
  for (const Group& group : groups_)
    for (int surplus = 0; surplus < group.surpluses(); ++surplus) {
      const hbSubspace& s = set_.subspace(group.levelsOf(surplus));
      glm::ivec3 slot(surplus % group.slots.x, surplus / group.slots.x % group.slots.y,
                      surplus / (group.slots.x * group.slots.y));
      hbSize3 node;
      for (node.z = 0; node.z < group.nodes.z; ++node.z)
        for (node.y = 0; node.y < group.nodes.y; ++node.y)
          for (node.x = 0; node.x < group.nodes.x; ++node.x) {
            hbSize3 at = node;
            for (int d = 0; d < 3; ++d)
              if (s.levels[d] == 0) at[d] = slot[d];
            result[std::size_t(s.offset + at.x + s.nodes.x * (at.y + s.nodes.y * at.z))] = group.begin(node) + surplus;
          }
    }
  return result;
}

std::vector<hbSize3> hbSurplusBlocks::samplesOf(const hbSize3& tile) const {
  const hbSize3& size = samples_.size();
  std::vector<hbSize3> samples;
  samples.reserve(std::size_t(edge_ * edge_ * edge_));
  for (std::int64_t z = tile.z * edge_; z < std::min(size.z, (tile.z + 1) * edge_); ++z)
    for (std::int64_t y = tile.y * edge_; y < std::min(size.y, (tile.y + 1) * edge_); ++y)
      for (std::int64_t x = tile.x * edge_; x < std::min(size.x, (tile.x + 1) * edge_); ++x)
        if (!hbFitSamples::isHeldOut(x + size.x * (y + size.y * z))) samples.emplace_back(x, y, z);
  return samples;
}

void hbSurplusBlocks::weights(const Group& group, const hbSize3& node, const hbSize3& sample,
                              std::span<double> out) const {
  std::array<std::array<double, 3>, 3> along;
  for (int d = 0; d < 3; ++d) {
    const hbHat<double>& hat = hats_[std::size_t(d)][std::size_t(sample[d])];
    auto& axis = along[std::size_t(d)];
    if (group.levels[d] == 1) {
      std::copy_n(hat.weight, std::size_t(group.slots[d]), axis.begin());
    } else {
      const int slot = group.levels[d] + 1;
      axis[0] = hat.node[slot] == node[d] ? hat.weight[slot] : 0.0;
    }
  }
  std::size_t i = 0;
  for (std::size_t z = 0; z < std::size_t(group.slots.z); ++z)
    for (std::size_t y = 0; y < std::size_t(group.slots.y); ++y) {
      const double yz = along[1][y] * along[2][z];
      for (std::size_t x = 0; x < std::size_t(group.slots.x); ++x) out[i++] = along[0][x] * yz;
    }
}

hbSurplusBlocks::Counts hbSurplusBlocks::counts() const {
  Counts counts;
  counts.tiles = double(tiles_.x) * double(tiles_.y) * double(tiles_.z);
  for (const Group& group : groups_) {
    double pieces = 1.0, rows = 1.0;
    for (int d = 0; d < 3; ++d) {
      double axisPieces = 0.0, axisRows = 0.0;
      for (std::int64_t tile = 0; tile < tiles_[d]; ++tile) {
        const double nodes = double(nodesAt(d, tile, group.levels[d]).size());
        axisPieces += nodes;
        axisRows += nodes * double(std::min(edge_, samples_.size()[d] - tile * edge_));
      }
      pieces *= axisPieces;
      rows *= axisRows;
    }
    counts.blocks += double(group.blocks());
    counts.pieces += pieces;
    counts.values += rows * group.surpluses();
  }
  return counts;
}
