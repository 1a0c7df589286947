#pragma once

#include <cstdint>

/// How the samples of a volume lie on the lattice of a representation. The numbers are those of the `.hbv` file.
///
/// Both are the same where every axis has 2^n + 1 samples.
enum class hbLatticeMapping : std::uint8_t {
  fitted = 0, ///< The lattice's cube is the volume's; nodes take the volume's trilinear value.
  aligned = 1 ///< Lattice node i is sample i; the volume fills [0, (N-1)/2^n] of an axis of 2^n + 1 nodes.
};
