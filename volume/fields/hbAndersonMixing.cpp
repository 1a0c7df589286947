#include "volume/fields/hbAndersonMixing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "volume/hbParallel.h"

namespace {

constexpr std::size_t kPiece = 1 << 14;

/// body(first, last) for pieces of a length that does not depend on the number of threads.
template <class Body>
void forPieces(std::size_t size, const Body& body) {
  hb::parallelFor(std::int64_t((size + kPiece - 1) / kPiece), [&](std::int64_t piece) {
    const std::size_t first = std::size_t(piece) * kPiece;
    body(first, std::min(size, first + kPiece));
  });
}

template <class A, class B>
double dot(const std::vector<A>& a, const std::vector<B>& b) {
  std::vector<double> sums((a.size() + kPiece - 1) / kPiece);
  forPieces(a.size(), [&](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) sum += double(a[i]) * double(b[i]);
    sums[first / kPiece] = sum;
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Solves the symmetric equations by Cholesky's method; directions that add nothing new to those before get 0.
std::vector<double> solveSymmetric(std::vector<std::vector<double>> a, std::vector<double> b) {
  // The products are of floats, whose rounding leaves dependent directions about this much.
  constexpr double kDependent = 1e-12;
  const std::size_t n = b.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double whole = a[i][i];
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      if (j < i) a[i][j] = a[j][j] > 0.0 ? a[i][j] / a[j][j] : 0.0;
    }
    a[i][i] = a[i][i] > kDependent * whole ? std::sqrt(a[i][i]) : 0.0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] = a[i][i] > 0.0 ? b[i] / a[i][i] : 0.0;
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
    b[i] = a[i][i] > 0.0 ? b[i] / a[i][i] : 0.0;
  }
  return b;
}

} // namespace

hbAndersonMixing::hbAndersonMixing(std::size_t size, std::size_t depth)
    : depth_(depth), residual_(size), mapped_(size) {
  assert(depth >= 1);
}

void hbAndersonMixing::next(std::vector<double>& x, const std::vector<double>& mapped) {
  assert(x.size() == residual_.size() && mapped.size() == residual_.size());
  const bool first = squared_ == 0.0;
  Change change;
  if (!first) {
    if (changes_.size() == depth_) {
      change = std::move(changes_.front());
      changes_.erase(changes_.begin());
      products_.erase(products_.begin());
      for (auto& row : products_) row.erase(row.begin());
    }
    change.residual.resize(x.size());
    change.mapped.resize(x.size());
  }
  forPieces(x.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double residual = mapped[i] - x[i];
      if (!first) {
        change.residual[i] = float(residual - residual_[i]);
        change.mapped[i] = float(mapped[i] - mapped_[i]);
      }
      residual_[i] = residual;
      mapped_[i] = mapped[i];
    }
  });
  const double squared = dot(residual_, residual_);
  const bool grew = squared > 16.0 * squared_;
  squared_ = squared;
  x = mapped;
  if (first || grew) {
    changes_.clear();
    products_.clear();
    return;
  }
  changes_.push_back(std::move(change));
  std::vector<double> row, right;
  for (const Change& c : changes_) {
    row.push_back(dot(changes_.back().residual, c.residual));
    right.push_back(dot(c.residual, residual_));
  }
  for (std::size_t i = 0; i + 1 < row.size(); ++i) products_[i].push_back(row[i]);
  products_.push_back(row);
  const std::vector<double> share = solveSymmetric(products_, right);
  forPieces(x.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < changes_.size(); ++c)
      for (std::size_t i = begin; i < end; ++i) x[i] -= share[c] * double(changes_[c].mapped[i]);
  });
}
