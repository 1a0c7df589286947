#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volume/hbField.h"

/// Where the values of an hbSemiNodalGrid lie, as its kernel walks through them.
struct hbSemiNodalTerms {
  /// One block of lines along x: a *slot* of y and one of z, with one line for each pair of their nodes. Slots 0 and 1
  /// of an axis are the lower and the upper node of the base cell around the point (of a flat axis slot 0 alone is in
  /// use); slot l >= 2 is the node of level l whose hat is not zero there.
  struct Term {
    std::int32_t slotY = 0, slotZ = 0;
    std::int32_t nodesY = 1; ///< Lines of the block for each of its nodes along z.
    std::int64_t offset = 0; ///< Of its first value.
  };
  /// The terms whose lines have 2^level cells, and so two nodes around the point and their weights in common.
  struct Group {
    int level = 0;
    std::size_t begin = 0, end = 0; ///< Into `terms`.
  };
  struct Axis {
    std::int32_t baseCells = 0; ///< Cells of the base grid: 2, of a coarse axis 1, of a flat one 0.
    int finest = 0;
    double scale = 1.0; ///< Lattice coordinate = scale * cube coordinate.
  };
  std::array<Axis, 3> axes;
  std::vector<Term> terms;
  std::vector<Group> groups;
};

namespace hb {

/// The values of an hbSemiNodalGrid, and its gradients per unit of the cube where `gradient` is given, in the
/// arithmetic of the points' type.
void evaluateSemiNodal(const hbSemiNodalTerms& terms, const float* values, const hbPoints& points, std::span<float> out,
                       const hbGradients* gradient);
void evaluateSemiNodal(const hbSemiNodalTerms& terms, const float* values, const hbPoints64& points,
                       std::span<double> out, const hbGradients64* gradient);

} // namespace hb
