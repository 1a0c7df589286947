#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sparsegrid/kernels/hbLatticeAxis.h"
#include "volume/hbField.h"

/// Where the surpluses of an hbSparseGrid lie, as the direct evaluation walks through them.
struct hbDirectTerms {
  /// One y and one z slot (see hbHat) and the arrays of lx = 0, 1, ... that belong to their levels: at a point, each
  /// row contributes the sum over lx of one value an array, weighted by the hats of y and z.
  struct Row {
    std::int32_t slotY = 0, slotZ = 0;
    std::int32_t nodesY = 1;     ///< Nodes along y of its subspaces.
    std::int32_t levels = 0;     ///< Of x, level 0 included.
    std::size_t firstOffset = 0; ///< Into `offsets`: where the array of lx = 0 begins; then lx = 1 and so on.
  };
  std::array<hbLatticeAxis, 3> axes;
  std::vector<Row> rows;
  std::vector<std::int64_t> offsets;
};

namespace hb {

/// The values of an hbSparseGrid, and its gradients per unit of the cube where `gradient` is given: weights in the
/// points' type, sums over rows in 64 bits.
void evaluateDirect(const hbDirectTerms& terms, const float* surpluses, const hbPoints& points, std::span<float> out,
                    const hbGradients* gradient);
void evaluateDirect(const hbDirectTerms& terms, const float* surpluses, const hbPoints64& points, std::span<double> out,
                    const hbGradients64* gradient);

} // namespace hb
