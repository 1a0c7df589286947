#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "fitting/hbFitSamples.h"
#include "sparsegrid/hbHat.h"
#include "sparsegrid/hbIndexSet.h"

/// The matrix of a sparse grid's values at samples, cut into dense pieces: the rows are samples in tiles, the columns
/// surpluses in blocks.
///
/// A tile is `edge` samples an axis, fewer at the end; those held out are left out. The hats of levels 0 and 1 of an
/// axis are not zero at (almost) any sample, so a block holds all surpluses that differ in these only: up to 27. Pieces
/// of nothing but zeros are left out: an axis' hats are looked at, whose products the pieces are.
class hbSurplusBlocks {
public:
  static constexpr int kMostSurpluses = 27;

  /// Blocks of the same levels, level 1 standing for 0 and 1. Those of different nodes follow each other, x fastest.
  struct Group {
    glm::ivec3 levels{1};
    glm::ivec3 slots{1}; ///< A block's surpluses along the axes, x fastest.
    hbSize3 nodes{1};    ///< A block for each; 1 along axes of level 1.
    std::int64_t offset = 0;

    int surpluses() const { return slots.x * slots.y * slots.z; }
    std::int64_t blocks() const { return nodes.x * nodes.y * nodes.z; }
    /// Where the surpluses of that node's block begin, in the order of blocks.
    std::int64_t begin(const hbSize3& node) const {
      return offset + surpluses() * (node.x + nodes.x * (node.y + nodes.y * node.z));
    }
    /// The levels of one of a block's surpluses.
    glm::ivec3 levelsOf(int surplus) const;
  };

  /// Keeps a reference to samples and set.
  hbSurplusBlocks(const hbFitSamples& samples, const hbIndexSet& set, std::int64_t edge);

  const std::vector<Group>& groups() const { return groups_; }
  /// For each surplus of the set where it is in the order of blocks.
  std::vector<std::int64_t> order() const;

  const hbSize3& tiles() const { return tiles_; }
  /// The samples of a tile that are not held out: their places along the axes.
  std::vector<hbSize3> samplesOf(const hbSize3& tile) const;

  /// Calls visit(group, node) for each block that is not zero at the samples of a tile.
  template <class Visit>
  void forBlocks(const hbSize3& tile, Visit visit) const {
    for (const Group& group : groups_) {
      const auto &xs = nodesAt(0, tile.x, group.levels.x), &ys = nodesAt(1, tile.y, group.levels.y);
      for (const std::int64_t z : nodesAt(2, tile.z, group.levels.z))
        for (const std::int64_t y : ys)
          for (const std::int64_t x : xs) visit(group, hbSize3(x, y, z));
    }
  }

  /// The products of hats of a block at a sample: group.surpluses() of them.
  void weights(const Group& group, const hbSize3& node, const hbSize3& sample, std::span<double> out) const;

  /// How much there is, samples held out included. O(tiles of the axes times groups).
  struct Counts {
    double tiles = 0.0, blocks = 0.0;
    double pieces = 0.0; ///< That are not left out.
    double values = 0.0; ///< In these.
  };
  Counts counts() const;

private:
  const std::vector<std::int64_t>& nodesAt(int axis, std::int64_t tile, int level) const {
    return nodes_[std::size_t(axis)][std::size_t(tile * (set_.finest()[axis] + 2) + level)];
  }
  void findNodes(int axis);

  const hbFitSamples& samples_;
  const hbIndexSet& set_;
  std::int64_t edge_;
  std::vector<Group> groups_;
  hbSize3 tiles_{0};
  std::array<std::vector<hbHat<double>>, 3> hats_;              ///< Of the axes at their samples.
  std::array<std::vector<std::vector<std::int64_t>>, 3> nodes_; ///< By tile and level; of level 1 one.
};
