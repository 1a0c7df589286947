#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "scene/hbTransferFunction.h"

/// What slabs of one thickness add to a picture, for all values at which a ray enters and leaves them: the volume
/// integral over a value that varies linearly in between. Steps of the transfer function, or peaks between two samples,
/// are then met without finer sampling. It belongs to one function, unit length and thickness.
///
/// K. Engel, M. Kraus, T. Ertl, "High-Quality Pre-Integrated Volume Rendering Using Hardware-Accelerated Pixel
/// Shading", Graphics Hardware 2001, and with the attenuation inside a slab, which they leave out of their fast form.
/// For the pairs of values k entries apart, slabs are windows of k cells, each of which a ray crosses in d / k; all
/// windows of one length are composited in linear time from prefixes and suffixes of blocks (M. van Herk, "A fast
/// algorithm for local minimum and maximum filters", Pattern Recognition Letters 13, 1992, for any associative
/// operation). So N^2 pairs take O(N^2).
///
/// Inside a cell, of h = (hi - lo) / (N - 1) values, the colour is its mean weighted by extinction, and both are means
/// of kSamplesPerCell samples. At entries, colours are therefore off by at most what the colour changes over one cell
/// times the opacity of one cell, and opacities by d times the error of that mean extinction, which for extinctions of
/// slope S is S h / (2 kSamplesPerCell) at most and falls with the square of h where they are smooth.
class hbPreintegration {
public:
  static constexpr std::size_t kDefaultEntries = 256, kMaxEntries = 2048, kSamplesPerCell = 8;

  /// For values in [lo, hi], the data's range, and slabs of this world length. 16 N^2 bytes. Throws hbError unless the
  /// function states its unit length, lo < hi are in the range of 32-bit floats, the thickness is positive and finite,
  /// and there are 2 to kMaxEntries entries.
  hbPreintegration(const hbTransferFunction& function, double lo, double hi, double thickness,
                   std::size_t entries = kDefaultEntries);

  /// Colour in linear light, premultiplied, and opacity of the slab in [0,1], interpolated between four entries. Values
  /// outside the range count as its ends; NaN for either is nothing. O(1).
  glm::vec4 at(float front, float back) const;

  /// Whether both values lie in the stretch without extinction at the same end of all values, so that at() has no
  /// opacity: faster than to look. Not for every such slab.
  bool isClear(float front, float back) const {
    return (front < clearBelow_ && back < clearBelow_) || (front > clearAbove_ && back > clearAbove_);
  }

  /// N x N, the value at the back running fastest.
  const std::vector<glm::vec4>& entries() const { return entries_; }
  std::size_t size() const { return size_; }
  /// The values of the first and the last entry.
  std::pair<double, double> range() const { return {lo_, hi_}; }

private:
  std::size_t size_;
  std::vector<glm::vec4> entries_;
  double lo_, hi_, entriesPerValue_;
  double clearBelow_, clearAbove_;
};
