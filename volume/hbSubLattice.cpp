#include "volume/hbSubLattice.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "volume/hbError.h"

hbSubLattice::hbSubLattice(const hbGeometry& source) : source_(source) {
  for (int d = 0; d < 3; ++d) axes_[std::size_t(d)].count = source.size[d];
}

hbSize3 hbSubLattice::size() const { return {axes_[0].count, axes_[1].count, axes_[2].count}; }

hbSubLattice hbSubLattice::box(const hbSize3& first, const hbSize3& last) const {
  hbSubLattice result(*this);
  for (int d = 0; d < 3; ++d) {
    Axis& axis = result.axes_[std::size_t(d)];
    if (first[d] < 0 || first[d] > last[d] || last[d] >= axis.count)
      throw hbError(fmt::format("box: expected first:last from 0:0 to {0}:{0} along {1}, found {2}:{3}", axis.count - 1,
                                "xyz"[d], first[d], last[d]));
    axis.first += axis.step * double(first[d]);
    axis.count = last[d] - first[d] + 1;
  }
  return result;
}

hbSubLattice hbSubLattice::thinned(int lod) const {
  assert(lod >= 0 && lod <= kMaxLod);
  hbSubLattice result(*this);
  for (Axis& axis : result.axes_) {
    if (axis.count == 1) continue;
    const std::int64_t stride = std::min(std::int64_t{1} << lod, axis.count - 1);
    axis.step *= double(stride);
    axis.count = (axis.count - 1) / stride + 1;
  }
  return result;
}

hbSubLattice hbSubLattice::resized(const hbSize3& size) const {
  hbSubLattice result(*this);
  for (int d = 0; d < 3; ++d) {
    Axis& axis = result.axes_[std::size_t(d)];
    const std::int64_t count = size[d];
    if (count == axis.count) continue;
    const double cells = double(axis.count - 1), newCells = double(count - 1);
    if (axis.count == 1 && !source_.isFlat(d))
      throw hbError(fmt::format("size: expected 1 along {}, where the box has one sample, found {}", "xyz"[d], count));
    if (axis.count == 1) // half a spacing to each side of the only sample
      axis = {-newCells, 2.0, 2.0 * newCells, count};
    else if (count == 1)
      axis = {2.0 * axis.first + axis.step * cells, 2.0 * axis.step * cells, 2.0 * axis.unit, 1};
    else
      axis = {axis.first * newCells, axis.step * cells, axis.unit * newCells, count};
  }
  return result;
}

hbGeometry hbSubLattice::geometry() const {
  hbGeometry geometry = source_;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = axes_[std::size_t(d)];
    geometry.origin += source_.spacing[d] * axis.first / axis.unit * source_.direction[d];
    geometry.spacing[d] = source_.spacing[d] * axis.step / axis.unit;
    geometry.size[d] = axis.count;
  }
  return geometry;
}

std::vector<double> hbSubLattice::cubeCoordinates(int axis) const {
  const auto& [first, step, unit, count] = axes_[std::size_t(axis)];
  std::vector<double> coordinates;
  coordinates.reserve(std::size_t(count));
  // Numerator and denominator are whole, so the one division rounds every fraction of the same value to the same float.
  // A flat axis covers half a spacing on each side of its sample.
  const bool flat = source_.isFlat(axis);
  const double cells = flat ? 2.0 : double(source_.size[axis] - 1);
  for (std::int64_t k = 0; k < count; ++k) {
    const double place = first + step * double(k);
    coordinates.push_back((flat ? 2.0 * place + unit : place) / (unit * cells));
  }
  return coordinates;
}
