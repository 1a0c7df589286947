#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sparsegrid/hbSparseGrid.h"

struct hbCombinationTerms;

/// A sparse grid by the combination technique: full component grids, each interpolated trilinearly, summed with their
/// coefficients (the `combination` engine). The same function as the hbSparseGrid it is made from, up to rounding.
///
/// Source: the sparse-grid paper, section 3, equation (11), generalised to any downward closed index set. Immutable.
class hbCombinationSparseGrid final : public hbField {
public:
  /// Dehierarchises `grid` into its component grids; O(values in all of them), 4 bytes each. Throws hbError where one
  /// of them has 2^31 values or more.
  explicit hbCombinationSparseGrid(const hbSparseGrid& grid);
  /// The same with other coefficients, in the order of componentGrids(), the same for all components. It is the
  /// function of the sparse grid whose subspace k has the surpluses of `grid` times the sum of the coefficients of the
  /// component grids that k is part of. Throws hbError for another number of them, and where one is not finite.
  hbCombinationSparseGrid(const hbSparseGrid& grid, std::span<const double> coefficients);

  /// The memory that building it takes, its temporary nodal values included.
  static double bytes(const hbIndexSet& set, int components);

  struct Grid {
    glm::ivec3 levels{0};
    double coefficient = 0.0;
    hbSize3 nodes{1};
    std::int64_t offset = 0; ///< Of its first value in an array over all grids.

    std::int64_t count() const { return nodes.x * nodes.y * nodes.z; }
  };
  const std::vector<Grid>& grids() const { return grids_; }
  /// Coordinate in the grids = latticeScale() * cube coordinate, see hbSparseGrid::latticeScale().
  glm::dvec3 latticeScale() const;
  /// The nodal values of all grids, each from its offset on.
  std::span<const float> values(int component) const {
    const Grid& last = grids_.back();
    return std::span(values_[std::size_t(component)]).first(std::size_t(last.offset + last.count()));
  }
  /// The nodal values of one grid, x fastest.
  std::span<const float> values(const Grid& grid, int component) const {
    return values(component).subspan(std::size_t(grid.offset), std::size_t(grid.count()));
  }

  const hbGeometry& geometry() const override { return frame_.geometry; }
  int components() const override { return int(values_.size()); }
  hbValueMap valueMap() const override { return frame_.valueMap; }
  /// O(component grids) a point; trilinear in 32 bits, summed in 64.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  /// The same with everything but the nodal values in 64 bits.
  void values(const hbPoints64& points, int component, std::span<double> out) const;
  void gradients(const hbPoints64& points, int component, std::span<double> out, const hbGradients64& gradient) const;
  /// One value, trilinear in 32 bits and summed in 64, without vector instructions.
  float calcValue32(const glm::vec3& point, int component) const;
  /// Sums each grid's least and greatest value among the cells the box meets, by the sign of its coefficient.
  hbRange range(const hbBox& box, int component) const override;

private:
  hbSparseGrid::Frame frame_;
  std::vector<Grid> grids_;
  std::vector<std::vector<float>> values_; ///< One array a component, over all grids.
  std::shared_ptr<const hbCombinationTerms> terms_;
};
