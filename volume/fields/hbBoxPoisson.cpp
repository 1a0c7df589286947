#include "volume/fields/hbBoxPoisson.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "volume/hbParallel.h"

namespace {

/// A matrix inside an array: its first element, and the distance between rows.
template <class T>
struct Matrix {
  T* data;
  std::int64_t stride;
  T* row(std::int64_t r) const { return data + r * stride; }
};

/// A block of Rows x Cols of c = a b, kept in registers.
template <int Rows, int Cols>
void multiplyBlock(Matrix<const double> a, Matrix<const double> b, Matrix<double> c, std::int64_t inner) {
  double sum[Rows][Cols] = {};
  for (std::int64_t k = 0; k < inner; ++k) {
    const double* const line = b.row(k);
    for (int r = 0; r < Rows; ++r) {
      const double factor = a.row(r)[k];
      for (int s = 0; s < Cols; ++s) sum[r][s] += factor * line[s];
    }
  }
  for (int r = 0; r < Rows; ++r)
    for (int s = 0; s < Cols; ++s) c.row(r)[s] = sum[r][s];
}

/// c (rows x cols) = a (rows x inner) b (inner x cols). Every sum is taken in the order of the inner index.
void multiply(Matrix<const double> a, Matrix<const double> b, Matrix<double> c, std::int64_t rows, std::int64_t inner,
              std::int64_t cols) {
  constexpr int kRows = 4, kCols = 4;
  const auto block = [&](auto blockRows, auto blockCols, std::int64_t r, std::int64_t s) {
    multiplyBlock<blockRows(), blockCols()>({a.row(r), a.stride}, {b.data + s, b.stride}, {c.row(r) + s, c.stride},
                                            inner);
  };
  using One = std::integral_constant<int, 1>;
  std::int64_t r = 0;
  for (; r + kRows <= rows; r += kRows) {
    std::int64_t s = 0;
    for (; s + kCols <= cols; s += kCols)
      block(std::integral_constant<int, kRows>(), std::integral_constant<int, kCols>(), r, s);
    for (; s < cols; ++s) block(std::integral_constant<int, kRows>(), One(), r, s);
  }
  for (; r < rows; ++r) {
    std::int64_t s = 0;
    for (; s + kCols <= cols; s += kCols) block(One(), std::integral_constant<int, kCols>(), r, s);
    for (; s < cols; ++s) block(One(), One(), r, s);
  }
}

} // namespace

hbBoxPoisson::Axis::Axis(std::int64_t count, double width) : n(count), evens((count + 1) / 2), odds(count / 2) {
  // Column i < odds of an even row stands for cells i and n-1-i at once; of an odd row, for their difference. Where n
  // is odd, the middle cell is the even rows' last column.
  const auto fill = [&](std::int64_t half, std::int64_t first, std::vector<double>& matrix, std::vector<double>& back) {
    matrix.resize(std::size_t(half * half));
    back.resize(matrix.size());
    for (std::int64_t m = 0; m < half; ++m) {
      const std::int64_t k = 2 * m + first;
      const double norm = std::sqrt((k == 0 ? 1.0 : 2.0) / double(n)),
                   s = std::sin(std::numbers::pi * double(k) / double(2 * n));
      eigenvalues.push_back(-4.0 * s * s / (width * width));
      for (std::int64_t i = 0; i < half; ++i) {
        const double value = norm * std::cos(std::numbers::pi * double(k * (2 * i + 1)) / double(2 * n));
        matrix[std::size_t(m * half + i)] = value;
        back[std::size_t(i * half + m)] = value;
      }
    }
  };
  fill(evens, 0, even, evenBack);
  fill(odds, 1, odd, oddBack);
}

/// Along the slow index of an n x width matrix.
void hbBoxPoisson::Axis::forward(double* values, std::int64_t stride, std::int64_t width, double* work) const {
  double* const differences = work + evens * width;
  for (std::int64_t i = 0; i < odds; ++i) {
    const double *const lower = values + i * stride, *const upper = values + (n - 1 - i) * stride;
    for (std::int64_t x = 0; x < width; ++x) {
      work[i * width + x] = lower[x] + upper[x];
      differences[i * width + x] = lower[x] - upper[x];
    }
  }
  if (evens > odds) std::copy_n(values + odds * stride, width, work + odds * width);
  multiply({even.data(), evens}, {work, width}, {values, stride}, evens, evens, width);
  multiply({odd.data(), odds}, {differences, width}, {values + evens * stride, stride}, odds, odds, width);
}

void hbBoxPoisson::Axis::backward(double* values, std::int64_t stride, std::int64_t width, double* work) const {
  double* const differences = work + evens * width;
  multiply({evenBack.data(), evens}, {values, stride}, {work, width}, evens, evens, width);
  multiply({oddBack.data(), odds}, {values + evens * stride, stride}, {differences, width}, odds, odds, width);
  for (std::int64_t i = 0; i < odds; ++i) {
    double *const lower = values + i * stride, *const upper = values + (n - 1 - i) * stride;
    for (std::int64_t x = 0; x < width; ++x) {
      const double e = work[i * width + x], o = differences[i * width + x];
      lower[x] = e + o;
      upper[x] = e - o;
    }
  }
  if (evens > odds) std::copy_n(work + odds * width, width, values + odds * stride);
}

/// Along the fast index of a rows x n matrix.
void hbBoxPoisson::Axis::forwardRows(double* values, std::int64_t rows, double* work) const {
  for (std::int64_t r = 0; r < rows; ++r) {
    const double* const from = values + r * n;
    double* const to = work + r * n;
    for (std::int64_t i = 0; i < odds; ++i) {
      to[i] = from[i] + from[n - 1 - i];
      to[evens + i] = from[i] - from[n - 1 - i];
    }
    if (evens > odds) to[odds] = from[odds];
  }
  multiply({work, n}, {evenBack.data(), evens}, {values, n}, rows, evens, evens);
  multiply({work + evens, n}, {oddBack.data(), odds}, {values + evens, n}, rows, odds, odds);
}

void hbBoxPoisson::Axis::backwardRows(double* values, std::int64_t rows, double* work) const {
  multiply({values, n}, {even.data(), evens}, {work, n}, rows, evens, evens);
  multiply({values + evens, n}, {odd.data(), odds}, {work + evens, n}, rows, odds, odds);
  for (std::int64_t r = 0; r < rows; ++r) {
    const double* const from = work + r * n;
    double* const to = values + r * n;
    for (std::int64_t i = 0; i < odds; ++i) {
      to[i] = from[i] + from[evens + i];
      to[n - 1 - i] = from[i] - from[evens + i];
    }
    if (evens > odds) to[odds] = from[odds];
  }
}

hbBoxPoisson::hbBoxPoisson(const hbSize3& cells, double width)
    : cells_(cells), axes_{Axis(cells.x, width), Axis(cells.y, width), Axis(cells.z, width)} {}

void hbBoxPoisson::solve(std::vector<double>& values) const {
  const Axis &ax = axes_[0], &ay = axes_[1], &az = axes_[2];
  const std::int64_t slab = ax.n * ay.n;
  hb::parallelFor(az.n, [&](std::int64_t z) {
    std::vector<double> work(static_cast<std::size_t>(slab));
    ax.forwardRows(values.data() + z * slab, ay.n, work.data());
    ay.forward(values.data() + z * slab, ax.n, ax.n, work.data());
  });
  hb::parallelFor(ay.n, [&](std::int64_t y) {
    std::vector<double> work(std::size_t(ax.n * az.n));
    double* const first = values.data() + y * ax.n;
    az.forward(first, slab, ax.n, work.data());
    for (std::int64_t z = 0; z < az.n; ++z) {
      const double yz = ay.eigenvalues[std::size_t(y)] + az.eigenvalues[std::size_t(z)];
      double* const row = first + z * slab;
      for (std::int64_t x = 0; x < ax.n; ++x) row[x] /= ax.eigenvalues[std::size_t(x)] + yz;
      if (yz == 0.0) row[0] = 0.0; // the constant, whose eigenvalue is 0
    }
    az.backward(first, slab, ax.n, work.data());
  });
  hb::parallelFor(az.n, [&](std::int64_t z) {
    std::vector<double> work(static_cast<std::size_t>(slab));
    ay.backward(values.data() + z * slab, ax.n, ax.n, work.data());
    ax.backwardRows(values.data() + z * slab, ay.n, work.data());
  });
}
