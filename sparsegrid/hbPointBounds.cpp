#include "sparsegrid/hbPointBounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "sparsegrid/hbHat.h"
#include "sparsegrid/hbRoundingBounds.h"

namespace {

/// So many roundings of each of `terms` that are `magnitude` together.
double rounded(double roundings, double magnitude, double terms) {
  constexpr double kHalfOfLeast = 0x1p-150;
  return roundings * (0x1p-24 * magnitude + kHalfOfLeast * terms);
}

} // namespace

hbPointBounds::hbPointBounds(const hbSparseGrid& grid, const hbCombinationSparseGrid& combination, int component)
    : grid_(grid), combination_(combination), component_(component),
      semiNodalRoundings_(hb::semiNodalRoundings(grid.indexSet())), latticeRoundings_(0.0) {
  for (int row = 0; row < 3; ++row)
    latticeRoundings_ = std::max(latticeRoundings_, hb::latticeRoundings(grid.indexSet(), row));
}

glm::dvec3 hbPointBounds::rounded(const glm::dvec3& point) const {
  if (grid_.latticeScale() == glm::dvec3(1.0)) return point;
  glm::dvec3 moved;
  for (int d = 0; d < 3; ++d) {
    const double scale = grid_.latticeScale()[d];
    moved[d] = double(float(point[d] * scale)) / scale;
  }
  return moved;
}

double hbPointBounds::coordinates(const glm::dvec3& point) const {
  const glm::dvec3 moved = rounded(point);
  return moved == point ? 0.0 : std::abs(grid_.calcValue(moved, component_) - grid_.calcValue(point, component_));
}

hbPointBounds::Magnitudes hbPointBounds::magnitudes(const glm::dvec3& point) const {
  const hbIndexSet& set = grid_.indexSet();
  std::array<hbHat<double>, 3> hats;
  for (int d = 0; d < 3; ++d)
    hats[std::size_t(d)].evaluate(grid_.latticeCoordinate(point[d], d), set.flat()[d], set.finest()[d]);
  Magnitudes sum;
  for (const hbSubspace& subspace : set.subspaces()) {
    const auto surpluses = grid_.surpluses(subspace, component_);
    const auto nodes = [&](int d) { return subspace.levels[d] == 0 && !set.flat()[d] ? 2 : 1; };
    const auto slot = [&](int d, int i) { return std::size_t(subspace.levels[d] == 0 ? i : subspace.levels[d] + 1); };
    const auto at = [&](int d, int i) { return std::int64_t(hats[std::size_t(d)].node[slot(d, i)]); };
    const auto weight = [&](int d, int i) { return hats[std::size_t(d)].weight[slot(d, i)]; };
    double largest = 0.0;
    for (int k = 0; k < nodes(2); ++k)
      for (int j = 0; j < nodes(1); ++j)
        for (int i = 0; i < nodes(0); ++i) {
          const std::int64_t index = at(0, i) + subspace.nodes.x * (at(1, j) + subspace.nodes.y * at(2, k));
          const double s = std::abs(double(surpluses[std::size_t(index)]));
          sum.weighted += weight(0, i) * weight(1, j) * weight(2, k) * s;
          largest = std::max(largest, s);
          ++sum.terms;
        }
    sum.covering += largest;
  }
  return sum;
}

double hbPointBounds::stored(const glm::dvec3& point) const {
  const Magnitudes there = magnitudes(point);
  return ::rounded(1.0, there.weighted, there.terms);
}

double hbPointBounds::direct(const glm::dvec3& point) const {
  const Magnitudes there = magnitudes(rounded(point));
  return ::rounded(hb::directRoundings(grid_.indexSet()), there.weighted, there.terms) + coordinates(point);
}

// A line's values at both ends of a cell, weighted, are together as large as the weighted surpluses they are made of:
// hats are linear in the cell.
double hbPointBounds::semiNodal(const glm::dvec3& point) const {
  const Magnitudes there = magnitudes(rounded(point));
  return ::rounded(semiNodalRoundings_, there.weighted, there.terms) + coordinates(point);
}

double hbPointBounds::lattice(const glm::dvec3& point) const {
  const Magnitudes there = magnitudes(point);
  return ::rounded(latticeRoundings_, there.covering, there.terms);
}

double hbPointBounds::combination(const glm::dvec3& point) const {
  double magnitude = 0.0, terms = 0.0;
  for (const hbComponentValue& one : hb::componentValues(combination_, rounded(point), component_)) {
    magnitude += std::abs(one.grid->coefficient) * one.largest;
    terms += std::abs(one.grid->coefficient);
  }
  return ::rounded(hb::kCombinationRoundings, magnitude, terms) + coordinates(point);
}
