#pragma once

#include <cstdint>
#include <span>
#include <vector>

/// How the rows of a lattice are put together at one place along z: what the kernel walks through.
struct hbLatticeRows {
  /// One slot of y (see hbHat) and one level of x: an array [nodes of y][count] in the plane.
  struct Part {
    std::int32_t slotY = 0;
    std::int64_t offset = 0; ///< Of the array in the plane.
  };
  /// The parts of one level of x.
  struct Level {
    std::int64_t count = 0; ///< Nodes along x.
    std::size_t begin = 0, end = 0;
  };
  std::vector<Part> parts;
  std::vector<Level> levels; ///< From 0 to the finest level of x.
};

namespace hb {

/// sum[i] += weight * values[i].
void addWeighted(const float* values, std::int64_t count, double weight, double* sum);

/// The row at one place along y: of every level of x the parts' rows, weighted and summed, then dehierarchised. `plane`
/// holds the parts' arrays; `node` and `weight` are those of the slots of y. Returns the row's 2^finest + 1 nodal
/// values (of a flat axis the one value), in either half of `scratch`, which takes twice as many; `surpluses` takes as
/// many as the finest level of x has nodes, at least 2.
const double* latticeRow(const hbLatticeRows& rows, const double* plane, const std::int32_t* node, const double* weight,
                         std::span<double> surpluses, std::span<double> scratch);

/// out[i] = values[i], rounded.
void roundToFloats(const double* values, std::int64_t count, float* out);

} // namespace hb
