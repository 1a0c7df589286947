#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sparsegrid/hbSparseGrid.h"

struct hbSemiNodalTerms;

/// A sparse grid kept nodal along x and hierarchical along y and z (the `seminodal` engine): the fast way to evaluate
/// it at any point. The same function as the hbSparseGrid it is made from, up to rounding.
///
/// For each pair of levels (ly,lz) and each node of both there is one line of 2^m + 1 values along x, m the finest lx
/// beside them. Levels 0 and 1 of y and of z have lines of one length; they are merged into a nodal *base grid* of
/// three nodes (two on a coarse axis). A point so needs about n(n+1)/2 terms at level n instead of n^3/6, each of them
/// the linear interpolation between two adjacent values. It stores as many values as the sparse grid (on a flat x axis
/// twice). Immutable.
class hbSemiNodalGrid final : public hbField {
public:
  /// O(stored values). Throws hbError where the set does not fit.
  explicit hbSemiNodalGrid(const hbSparseGrid& grid);

  /// Whether no pair of levels has 2^31 values or more.
  static bool fits(const hbIndexSet& set);
  /// The memory it takes.
  static double bytes(const hbIndexSet& set, int components);

  /// The stored values of all lines, and where each term finds its own: for those who evaluate the grid elsewhere.
  std::span<const float> values(int component) const { return values_[std::size_t(component)]; }
  const hbSemiNodalTerms& terms() const;

  const hbGeometry& geometry() const override { return frame_.geometry; }
  int components() const override { return int(values_.size()); }
  hbValueMap valueMap() const override { return frame_.valueMap; }

  /// In 32 bits: O(pairs of levels) a point; see doc/sparse-grids.md for the bound of the rounding.
  void values(const hbPoints& points, int component, std::span<float> out) const override;
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override;
  /// The same with everything but the stored values in 64 bits.
  void values(const hbPoints64& points, int component, std::span<double> out) const;
  void gradients(const hbPoints64& points, int component, std::span<double> out, const hbGradients64& gradient) const;

  /// Point by point, in 64 bits, rounded once. hbSparseGrid::lattice is the fast way.
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override;

  /// Sums each block's least and greatest value among those that meet the box: conservative.
  hbRange range(const hbBox& box, int component) const override;

private:
  struct Layout;
  hbSparseGrid::Frame frame_;
  std::shared_ptr<const Layout> layout_;
  std::vector<std::vector<float>> values_; ///< One array a component.
};
