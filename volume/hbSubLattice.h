#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volume/hbGeometry.h"

/// Evenly spaced places on the lattice of a volume's samples: a box of it, every n-th sample, another number of samples
/// on the same box. Each step starts from the places there are.
///
/// Places are kept as fractions of whole numbers, so that one that is a sample has exactly that sample's coordinate
/// (products of sizes below 2^53).
class hbSubLattice {
public:
  /// The coarsest level of detail of thinned().
  static constexpr int kMaxLod = 15;

  /// All samples of a volume with that (valid) geometry.
  explicit hbSubLattice(const hbGeometry& source);

  /// Places first to last of each axis, both included, counted from 0; an axis of one place becomes flat and keeps its
  /// spacing. Throws hbError unless 0 <= first <= last < size().
  hbSubLattice box(const hbSize3& first, const hbSize3& last) const;

  /// Every 2^lod-th place of each axis, the first one included; where those are less than two, the first and the last.
  /// What lies behind the last one taken is left out. 0 <= lod <= kMaxLod.
  hbSubLattice thinned(int lod) const;

  /// `size` places an axis on the same box: its ends and what divides it evenly, or its middle. Throws hbError for
  /// several places along an axis that a box made flat.
  hbSubLattice resized(const hbSize3& size) const;

  hbSize3 size() const;

  /// The source's, cut to these places: each keeps its position in the world. An axis of one place is as thick as its
  /// spacing; resized() keeps the box's thickness.
  hbGeometry geometry() const;

  /// The places along an axis in the source's cube, increasing.
  std::vector<double> cubeCoordinates(int axis) const;

private:
  /// Place k lies at (first + step k) / unit samples of the source; all three are whole.
  struct Axis {
    double first = 0.0, step = 1.0, unit = 1.0;
    std::int64_t count = 1;
  };

  hbGeometry source_;
  std::array<Axis, 3> axes_;
};
