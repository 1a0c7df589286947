#include "scene/hbOpacityRange.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
} // namespace

hbOpacityRange::hbOpacityRange(const hbTransferFunction& function)
    : below_(function.opacity(-kInfinity)), above_(function.opacity(kInfinity)) {
  const auto& points = function.definition().opacities;
  for (std::size_t first = 0, next = 0; first < points.size(); first = next) {
    while (next < points.size() && points[next].value == points[first].value) ++next;
    // Points between the first and the last of one value are never seen.
    const Point& last = points[next - 1];
    Break b{last.value, std::max(points[first].opacity, last.opacity), last,
            next < points.size() ? points[next] : last};
    if (first == 0) b.greatest = std::max(b.greatest, below_);
    if (next == points.size()) b.greatest = std::max(b.greatest, above_);
    breaks_.push_back(b);
  }

  const std::size_t n = breaks_.size();
  maxima_.emplace_back(n);
  for (std::size_t i = 0; i < n; ++i) maxima_[0][i] = breaks_[i].greatest;
  for (std::size_t length = 2; length <= n; length *= 2) {
    const std::vector<double>& halves = maxima_.back();
    std::vector<double> wholes(n - length + 1);
    for (std::size_t i = 0; i < wholes.size(); ++i) wholes[i] = std::max(halves[i], halves[i + length / 2]);
    maxima_.push_back(std::move(wholes));
  }

  const double width = breaks_.back().value - breaks_.front().value;
  const std::size_t cells = 2 * n;
  cellsPerValue_ = width > 0.0 ? double(cells) / width : 0.0;
  if (!std::isfinite(cellsPerValue_)) cellsPerValue_ = 0.0; // denormal widths: all in one cell
  firstInCell_.assign(cells + 2, std::uint32_t(n));
  for (std::size_t i = n; i-- > 0;) firstInCell_[cellOf(breaks_[i].value)] = std::uint32_t(i);
  for (std::size_t cell = firstInCell_.size() - 1; cell-- > 0;)
    firstInCell_[cell] = std::min(firstInCell_[cell], firstInCell_[cell + 1]);
}

// Rounding does not change the order of two values, so breaks of other cells need not be compared.
std::size_t hbOpacityRange::cellOf(double value) const {
  const double place = (value - breaks_.front().value) * cellsPerValue_;
  return place > 0.0 ? std::size_t(std::min(place, double(firstInCell_.size() - 2))) : 0;
}

std::size_t hbOpacityRange::firstAtLeast(double value) const {
  if (value > breaks_.back().value) return breaks_.size();
  const std::size_t cell = cellOf(value);
  const auto begin = breaks_.begin();
  const auto found = std::lower_bound(begin + firstInCell_[cell], begin + firstInCell_[cell + 1], value,
                                      [](const Break& b, double x) { return b.value < x; });
  return std::size_t(found - begin);
}

double hbOpacityRange::opacity(std::size_t firstBreakAtLeast, double value) const {
  if (firstBreakAtLeast == 0) return below_;
  if (firstBreakAtLeast == breaks_.size()) return above_;
  const Break& piece = breaks_[firstBreakAtLeast - 1];
  return hbTransferFunction::opacityBetween(piece.above, piece.end, value);
}

double hbOpacityRange::maximum(double lo, double hi) const {
  if (std::isnan(lo)) lo = -kInfinity;
  if (std::isnan(hi)) hi = kInfinity;
  if (lo > hi) return 0.0;
  // Opacity is monotone between breaks: its maximum is at an end of the interval or at a break inside.
  const std::size_t first = firstAtLeast(lo);
  std::size_t end = firstAtLeast(hi);
  double result = std::max(opacity(first, lo), opacity(end, hi));
  if (end < breaks_.size() && breaks_[end].value == hi) ++end;
  if (first < end) {
    const std::size_t length = std::bit_floor(end - first);
    const auto& maxima = maxima_[std::size_t(std::countr_zero(length))];
    result = std::max({result, maxima[first], maxima[end - length]});
  }
  return result;
}
