#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include "scene/hbTransferFunction.h"

/// A transfer function sampled at N equidistant values over its range, first and last included, for fast look-up: 16 N
/// bytes. It belongs to the function and the unit length it was built from; another function needs another one.
///
/// Between two entries the colour and the extinction are interpolated linearly. Each of them therefore lies between the
/// function's at the two ends of the cell, and where it is continuous and monotone over the cell, it is the function's
/// at a value less than one spacing h = (hi - lo) / (N - 1) away. Where it has a bounded second derivative M in the
/// cell, it is off by at most M h^2 / 8. A step is smeared over the cell it is in. To this comes the rounding of
/// entries to 32 bits and of one interpolation.
class hbTransferTable {
public:
  static constexpr std::size_t kDefaultEntries = 4096, kMaxEntries = std::size_t{1} << 20;

  /// Throws hbError unless the function states its unit length and there are 2 to kMaxEntries entries. O(N log points).
  explicit hbTransferTable(const hbTransferFunction& function, std::size_t entries = kDefaultEntries);

  /// Red, green and blue in linear light, in [0,1], and the extinction coefficient in 1 / world length. Not multiplied
  /// with each other. Values outside the range, and NaN, have entries of their own, which are exact. O(1).
  glm::vec4 at(float value) const {
    if (std::isnan(value)) return nan_;
    if (value < lo_) return below_;
    if (value > hi_) return above_;
    const double place = (double(value) - lo_) * entriesPerValue_;
    const std::size_t cell = std::min(std::size_t(place), entries_.size() - 2);
    return glm::mix(entries_[cell], entries_[cell + 1], float(place - double(cell)));
  }

  /// Whether a value lies in one of the stretches without extinction at both ends of all values, so that at() has none:
  /// faster than to look. Not for every such value.
  bool isClear(float value) const { return value < clearBelow_ || value > clearAbove_; }

  const std::vector<glm::vec4>& entries() const { return entries_; }

  /// The values of the first and the last entry: the function's range().
  std::pair<double, double> range() const { return {lo_, hi_}; }

private:
  std::vector<glm::vec4> entries_;
  glm::vec4 below_{0.0F}, above_{0.0F}, nan_{0.0F};
  double lo_, hi_;
  double entriesPerValue_;
  double clearBelow_, clearAbove_;
};
