#pragma once

#include <array>
#include <vector>

#include "volume/hbGeometry.h"

/// Solves Poisson's equation with zero normal slope at the walls of a box of equal cubic cells, directly.
///
/// The unknowns are values at the cells' centres, the operator is the usual one of 7 points. Fast diagonalisation
/// (Lynch, Rice, Thomas, Direct solution of partial difference equations by tensor product methods, Numer. Math. 6,
/// 1964): along each axis the values are multiplied by the matrix of the operator's eigenvectors,
/// cos(pi k (i + 1/2) / n), divided by the sums of eigenvalues, and multiplied back. Each matrix falls into one for the
/// even and one for the odd eigenvectors, which halves the work.
class hbBoxPoisson {
public:
  /// `cells`: along x, y, z, each at least 2; `width`: of a cell.
  hbBoxPoisson(const hbSize3& cells, double width);

  const hbSize3& cells() const { return cells_; }

  /// `values` (x fastest, then y, z): the right side; becomes the solution whose mean is zero. A right side whose mean
  /// is not zero has no solution and is taken less its mean. 2 (x + y + z) operations a cell, on all threads; the
  /// result does not depend on their number.
  void solve(std::vector<double>& values) const;

private:
  /// What multiplies along one axis. The transformed values are ordered: even k, then odd k.
  struct Axis {
    Axis(std::int64_t n, double width);

    std::int64_t n, evens, odds;                      ///< n = evens + odds: lengths of the two halves.
    std::vector<double> even, evenBack, odd, oddBack; ///< [k][i] and [i][k], row by row.
    std::vector<double> eigenvalues;                  ///< Of the second difference; at most 0.
    void forward(double* values, std::int64_t stride, std::int64_t width, double* work) const;
    void backward(double* values, std::int64_t stride, std::int64_t width, double* work) const;
    void forwardRows(double* values, std::int64_t rows, double* work) const;
    void backwardRows(double* values, std::int64_t rows, double* work) const;
  };

  hbSize3 cells_;
  std::array<Axis, 3> axes_;
};
