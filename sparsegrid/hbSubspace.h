#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "volume/hbGeometry.h"

/// One subspace of the hierarchical basis: the tensor product of one level an axis.
///
/// Its nodes, and so its surpluses, form a dense array, x fastest. Along an axis, level 0 holds the two boundary nodes
/// (a flat axis its only node) and level l >= 1 the 2^(l-1) nodes (2k+1) 2^-l.
struct hbSubspace {
  glm::ivec3 levels{0};
  hbSize3 nodes{1};        ///< Nodes along x, y, z.
  std::int64_t offset = 0; ///< Of its first node in an array over the whole index set.

  std::int64_t count() const { return nodes.x * nodes.y * nodes.z; }
};

/// A level of a sparse grid: its subspaces of equal sum over the axes of max(l,1), minus 2 (as the sparse-grid paper
/// counts).
struct hbLevel {
  int number = 1;
  std::vector<hbSubspace> subspaces;
};
