#include "scene/hbPreintegration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "volume/hbError.h"

namespace {

/// A piece of a ray: what it adds, premultiplied, and how much of what is behind it lets through.
struct Piece {
  glm::dvec3 colour{0.0};
  double transmittance = 1.0;
};

Piece over(const Piece& front, const Piece& back) {
  return {front.colour + front.transmittance * back.colour, front.transmittance * back.transmittance};
}

glm::vec4 entryOf(const Piece& piece) { return glm::vec4(glm::dvec4(piece.colour, 1.0 - piece.transmittance)); }

/// Means over an interval of values.
struct Cell {
  double extinction = 0.0;
  glm::dvec3 emission{0.0}; ///< Extinction times colour.
};

Piece pieceOf(const Cell& cell, double length) {
  if (!(cell.extinction > 0.0)) return {};
  const double depth = cell.extinction * length;
  return {cell.emission / cell.extinction * -std::expm1(-depth), std::exp(-depth)};
}

} // namespace

hbPreintegration::hbPreintegration(const hbTransferFunction& function, double lo, double hi, double thickness,
                                   std::size_t entries)
    : size_(entries), lo_(lo), hi_(hi) {
  constexpr double kMaxValue = std::numeric_limits<float>::max(), kLeast = std::numeric_limits<float>::denorm_min();
  if (entries < 2 || entries > kMaxEntries)
    throw hbError(fmt::format("preintegration: expected 2 to {} entries, found {}", kMaxEntries, entries));
  if (!(hi - lo >= kLeast && std::abs(lo) <= kMaxValue && std::abs(hi) <= kMaxValue))
    throw hbError(fmt::format("preintegration: expected a range of two 32-bit floats, the first less than the second, "
                              "found {} to {}",
                              lo, hi));
  if (!(thickness > 0.0 && std::isfinite(thickness)))
    throw hbError(fmt::format("preintegration: expected a positive thickness, found {}", thickness));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t cells = entries - 1;
  entriesPerValue_ = double(cells) / (hi - lo);
  const auto valueAt = [&](double place) {
    const double t = place / double(cells);
    return (1.0 - t) * lo + t * hi;
  };

  std::vector<Cell> means(cells);
  for (std::size_t i = 0; i < cells; ++i)
    for (std::size_t s = 0; s < kSamplesPerCell; ++s) {
      const double value = valueAt(double(i) + (double(s) + 0.5) / kSamplesPerCell);
      const double extinction = function.extinction(value) / kSamplesPerCell;
      means[i].extinction += extinction;
      means[i].emission += extinction * function.colour(value);
    }

  entries_.resize(entries * entries);
  for (std::size_t i = 0; i < entries; ++i) {
    const double extinction = function.extinction(valueAt(double(i)));
    const Cell constant{extinction, extinction * function.colour(valueAt(double(i)))};
    entries_[i * entries + i] = entryOf(pieceOf(constant, thickness));
  }

  std::vector<Piece> pieces(cells), prefixes(cells), suffixes(cells);
  for (const bool rising : {true, false}) {
    for (std::size_t k = 1; k <= cells; ++k) {
      for (std::size_t i = 0; i < cells; ++i) pieces[i] = pieceOf(means[i], thickness / double(k));
      for (std::size_t i = 0; i < cells; ++i) prefixes[i] = i % k == 0 ? pieces[i] : over(prefixes[i - 1], pieces[i]);
      for (std::size_t i = cells; i-- > 0;)
        suffixes[i] = (i + 1) % k == 0 || i + 1 == cells ? pieces[i] : over(pieces[i], suffixes[i + 1]);
      for (std::size_t first = 0; first + k <= cells; ++first) {
        const Piece slab = first % k == 0 ? prefixes[first + k - 1] : over(suffixes[first], prefixes[first + k - 1]);
        const std::size_t front = rising ? first : cells - first, back = rising ? first + k : cells - first - k;
        entries_[front * entries + back] = entryOf(slab);
      }
    }
    std::reverse(means.begin(), means.end());
  }

  // Slabs from the first or the last value on pass all values on the way. A cell is left out for the rounding of
  // places.
  const auto isClear = [&](std::size_t i, std::size_t j) {
    return entries_[i * size_ + j].a == 0.0F && entries_[j * size_ + i].a == 0.0F;
  };
  std::size_t first = 0, end = size_;
  while (first < size_ && isClear(0, first)) ++first;
  while (end > 0 && isClear(size_ - 1, end - 1)) --end;
  clearBelow_ = first == 0 ? -kInfinity : lo_ + (double(first) - 2.0) / entriesPerValue_;
  clearAbove_ = end == size_ ? kInfinity : lo_ + (double(end) + 1.0) / entriesPerValue_;
}

glm::vec4 hbPreintegration::at(float front, float back) const {
  if (std::isnan(front) || std::isnan(back)) return glm::vec4(0.0F);
  const double last = double(size_ - 1);
  const double x = std::clamp((double(front) - lo_) * entriesPerValue_, 0.0, last);
  const double y = std::clamp((double(back) - lo_) * entriesPerValue_, 0.0, last);
  const std::size_t i = std::min(std::size_t(x), size_ - 2), j = std::min(std::size_t(y), size_ - 2);
  const glm::vec4* row = &entries_[i * size_ + j];
  const float u = float(x - double(i)), v = float(y - double(j));
  return glm::mix(glm::mix(row[0], row[1], v), glm::mix(row[size_], row[size_ + 1], v), u);
}
