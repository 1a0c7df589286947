#pragma once

#include <vector>

#include "sparsegrid/hbSparseGrid.h"

/// A sparse grid by the combination technique: full component grids, each interpolated trilinearly, summed with their
/// coefficients (the `combination` engine). The same function as the hbSparseGrid it is made from, up to rounding.
///
/// Source: the sparse-grid paper, section 3, equation (11), generalised to any downward closed index set. Immutable.
class hbCombinationSparseGrid final : public hbField {
public:
  /// Dehierarchises `grid` into its component grids; O(values in all of them), 4 bytes each.
  explicit hbCombinationSparseGrid(const hbSparseGrid& grid);

  struct Grid {
    glm::ivec3 levels{0};
    int coefficient = 0;
    hbSize3 nodes{1};
    std::vector<std::vector<float>> values; ///< One array a component: nodal values, x fastest.
  };
  const std::vector<Grid>& grids() const { return grids_; }

  const hbGeometry& geometry() const override { return frame_.geometry; }
  int components() const override { return int(grids_.front().values.size()); }
  hbValueMap valueMap() const override { return frame_.valueMap; }
  /// O(component grids) a point; trilinear in 32 bits, summed in 64.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  /// Sums each grid's least and greatest value among the cells the box meets, by the sign of its coefficient.
  hbRange range(const hbBox& box, int component) const override;

private:
  glm::vec3 latticePoint(const hbPoints& points, std::size_t i) const;

  hbSparseGrid::Frame frame_;
  glm::dvec3 scale_{1.0};
  std::vector<Grid> grids_;
};
