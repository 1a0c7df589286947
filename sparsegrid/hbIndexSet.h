#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "sparsegrid/hbSubspace.h"
#include "volume/hbGeometry.h"

/// The subspaces a sparse grid consists of, and where each one's nodes lie in an array over all of them.
///
/// A set is downward closed over levels >= 1: with (lx,ly,lz) it holds every index with no greater levels. Level 0 of
/// an axis belongs to level 1. An axis whose only level is 0 is *coarse*: it has two nodes, or one if it is flat.
///
/// Source: Teitzel, Hopf, Grosso, Ertl, Volume Visualization on Sparse Grids, sections 2 and 3, extended by boundary
/// nodes.
class hbIndexSet {
public:
  /// The finest level an axis may have: node coordinates stay exact in 32-bit floats, sizes in 64-bit integers.
  static constexpr int kMaxLevel = 20;

  /// Which axes are flat, and the finest level of each (0 for flat and for two-node axes).
  struct Axes {
    glm::ivec3 maxLevel{kMaxLevel};
    glm::bvec3 flat{false};
  };

  /// The axes that resolve `size` samples: the first level whose 2^l cells are at least size-1.
  static Axes axesOf(const hbSize3& size);
  /// Flat where `size` is 1, two nodes where it is 2, otherwise unlimited: for `--uncapped`.
  static Axes uncappedAxesOf(const hbSize3& size);

  /// The regular set of level n: sum over the axes of max(l,1) <= n + 2, within `axes`. n from 1 to kMaxLevel.
  static hbIndexSet regular(int n, const Axes& axes);
  /// The anisotropic sparse set, whose axes end at levels of their own: sum over the axes of
  /// (max(l,1) - 1) / (levels - 1) <= 1, within `axes`. An axis of level 1 has only levels 0 and 1, three nodes; coarse
  /// axes have level 0 whatever is given for them. Equal levels give the regular set. Each from 1 to kMaxLevel.
  static hbIndexSet anisotropic(const glm::ivec3& levels, const Axes& axes);
  /// Every index within `axes`: a full grid.
  static hbIndexSet full(const Axes& axes);
  /// From a list of all subspaces, level 0 included, in any order. Throws hbError naming `what` where it is not closed,
  /// holds an index twice, or exceeds kMaxLevel.
  static hbIndexSet fromList(const std::vector<glm::ivec3>& levels, const glm::bvec3& flat, const std::string& what);

  /// Every index that has no greater levels than one of the list, on each axis. Throws hbError as fromList() does:
  /// where the list is empty, exceeds kMaxLevel, or ends at level 0 of an axis that others refine.
  static hbIndexSet enclosing(const std::vector<glm::ivec3>& indices, const glm::bvec3& flat, const std::string& what);

  /// All subspaces, ordered by level, then lz, ly, lx; their arrays follow each other in this order.
  const std::vector<hbSubspace>& subspaces() const { return subspaces_; }
  /// The same, one entry a level.
  std::vector<hbLevel> levels() const;
  std::int64_t storedValues() const { return storedValues_; }

  bool contains(const glm::ivec3& levels) const;
  /// The subspace of that index; it must be contained.
  const hbSubspace& subspace(const glm::ivec3& levels) const;

  const glm::bvec3& flat() const { return flat_; }
  /// The finest level of each axis.
  const glm::ivec3& finest() const { return finest_; }
  /// The greatest number of a level (n for the uncapped regular set).
  int number() const;

  /// One component grid of the combination technique: (2^l+1) nodes an axis (1 on a flat axis) and its coefficient,
  /// sum over z in {0,1}^3 of (-1)^|z| [levels + z in the set].
  struct ComponentGrid {
    glm::ivec3 levels{0};
    int coefficient = 0;
    hbSize3 nodes{1};
  };
  /// Those with a coefficient other than 0, ordered as subspaces() are.
  std::vector<ComponentGrid> componentGrids() const;

  /// Values in all component grids together.
  std::int64_t combinationValues() const;
  /// Texels of 3D textures padded to powers of two, 2^(l+1) an axis, as the paper's hardware needed them.
  std::int64_t paddedTexels() const;

  /// Nodes of one axis at one level: 1 if flat, 2 at level 0, otherwise 2^(l-1).
  static std::int64_t axisNodes(bool flat, int level);

  /// One node of an axis: the level it belongs to, and its place there.
  struct AxisNode {
    int level;
    std::int64_t index;
  };
  /// The node at k 2^-level, 0 <= k <= 2^level (of a flat axis its only one).
  static AxisNode axisNode(bool flat, int level, std::int64_t k);

private:
  hbIndexSet(const std::vector<glm::ivec3>& levels, const glm::bvec3& flat, const std::string& what = "index set");
  std::size_t slot(const glm::ivec3& levels) const;

  glm::bvec3 flat_{false};
  glm::ivec3 finest_{0};
  std::vector<hbSubspace> subspaces_;
  std::vector<int> place_; ///< Place in subspaces_ or -1, over (finest+1)^3, x fastest.
  std::int64_t storedValues_ = 0;
};
