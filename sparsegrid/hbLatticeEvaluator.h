#pragma once

#include <span>
#include <vector>

#include "sparsegrid/hbHat.h"
#include "sparsegrid/hbSparseGrid.h"
#include "sparsegrid/kernels/hbLatticeKernel.h"

/// Evaluates one component of a sparse grid on a rectilinear lattice, plane by plane across z, axis by axis: for a
/// place along z the subspaces are summed over lz into one array for each (lx,ly); for a place along y these over ly
/// into one for each lx; and along x the row is dehierarchised, once for all its places. Each surplus is so touched
/// once a plane, not once a sample. In 64 bits, rounded once. What depends on x and y alone is prepared once.
class hbLatticeEvaluator {
public:
  /// Keeps a reference to `grid`. Coordinates of the cube, increasing; clamped to it (NaN to 0).
  hbLatticeEvaluator(const hbSparseGrid& grid, int component, std::span<const double> xs, std::span<const double> ys);

  /// out[x + strideY y] = the value at (xs[x], ys[y], z). May be called by several threads at once. O(surpluses) for
  /// the plane and O(samples + 2^finest lx) for a row.
  void plane(double z, float* out, std::size_t strideY) const;

private:
  /// The arrays of one (lx,ly) for all lz: where their planes begin, and where their sum goes.
  struct Column {
    std::int64_t count = 0;  ///< Surpluses of one plane.
    std::int64_t offset = 0; ///< In the summed plane.
    std::vector<const float*> byLevel;
  };
  /// One place along x between two adjacent nodes of a row.
  struct Place {
    std::int64_t cell = 0;
    double t = 0.0;
  };

  hbHat<double> hat(double coordinate, int axis) const;

  const hbSparseGrid& grid_;
  std::vector<Column> columns_;
  std::int64_t planeSize_ = 0;
  hbLatticeRows rows_;
  std::vector<hbHat<double>> hatsY_;
  std::vector<Place> places_; ///< Empty where the samples are adjacent nodes from firstNode_ on.
  std::int64_t firstNode_ = 0;
  std::size_t sizeX_ = 0;
};
