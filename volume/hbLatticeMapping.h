#pragma once

#include <cstdint>

/// How a volume's samples lie on the dyadic lattice of a hierarchical representation. The numbers are those of the
/// `.hbv` file.
enum class hbLatticeMapping : std::uint8_t {
  /// The lattice's cube is the volume's cube; a node takes the volume's trilinear value there.
  fitted = 0,
  /// Lattice node i is sample i: the volume fills [0, (N-1)/2^n] of an axis, n the least level with 2^n >= N-1.
  aligned = 1
};
