#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "sparsegrid/kernels/hbLatticeAxis.h"
#include "volume/hbField.h"

/// Where the nodal values of an hbCombinationSparseGrid lie, as its kernel walks through them.
struct hbCombinationTerms {
  struct Grid {
    glm::ivec3 levels{0};
    double coefficient = 0.0;
    std::int64_t strideY = 0, strideZ = 0; ///< In values; 0 along a flat axis.
    std::int64_t offset = 0;               ///< Of its first value.
  };
  std::array<hbLatticeAxis, 3> axes;
  std::vector<Grid> grids;
};

namespace hb {

/// The values of an hbCombinationSparseGrid, and its gradients per unit of the cube where `gradient` is given:
/// trilinear in the points' type, summed in 64 bits. One value past the last grid's is read (and not used) on a flat x
/// axis.
void evaluateCombination(const hbCombinationTerms& terms, const float* values, const hbPoints& points,
                         std::span<float> out, const hbGradients* gradient);
void evaluateCombination(const hbCombinationTerms& terms, const float* values, const hbPoints64& points,
                         std::span<double> out, const hbGradients64* gradient);

} // namespace hb
