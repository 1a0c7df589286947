#include "sparsegrid/hbRoundingBounds.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

namespace {

double largestSurplus(const hbSparseGrid& grid, const hbSubspace& subspace, int component) {
  float largest = 0.0F;
  for (const float s : grid.surpluses(subspace, component)) largest = std::max(largest, std::abs(s));
  return double(largest);
}

} // namespace

double hb::amplitude(const hbSparseGrid& grid, int component) {
  double sum = 0.0;
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) sum += largestSurplus(grid, subspace, component);
  return sum;
}

double hb::amplification(const hbIndexSet& set) {
  double sum = 0.0;
  for (const hbIndexSet::ComponentGrid& grid : set.componentGrids()) sum += std::abs(grid.coefficient);
  return sum;
}

double hb::amplification(const hbCombinationSparseGrid& grid) {
  double sum = 0.0;
  for (const hbCombinationSparseGrid::Grid& one : grid.grids()) sum += std::abs(one.coefficient);
  return sum;
}

glm::dvec3 hb::slopeBounds(const hbSparseGrid& grid, int component) {
  glm::dvec3 sum(0.0);
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) {
    const double largest = largestSurplus(grid, subspace, component);
    for (int d = 0; d < 3; ++d)
      if (!grid.indexSet().flat()[d])
        sum[d] += std::exp2(std::max(subspace.levels[d], 1)) * largest * grid.latticeScale()[d];
  }
  return sum;
}

double hb::coordinateBound(const hbSparseGrid& grid, int component) {
  if (grid.latticeScale() == glm::dvec3(1.0)) return 0.0;
  double sum = 0.0;
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) {
    const double largest = largestSurplus(grid, subspace, component);
    for (int d = 0; d < 3; ++d) sum += std::exp2(subspace.levels[d]) * 0x1p-25 * largest;
  }
  return sum;
}

double hb::directRoundings(const hbIndexSet& set) { return 9.0 + set.finest().x; }

double hb::semiNodalRoundings(const hbIndexSet& set) {
  std::map<int, int> terms; // of each length: one for each pair of levels, two for each base grid of more than one node
  const auto slots = [&](int d, int level) {
    const bool base = level <= std::min(1, set.finest()[d]);
    return base && !set.flat()[d] ? 2 : 1;
  };
  for (const hbSubspace& subspace : set.subspaces()) {
    const glm::ivec3 l = subspace.levels;
    // Level 1 has level 0 in it.
    if (l.x != 0 || (l.y == 0 && set.finest().y > 0) || (l.z == 0 && set.finest().z > 0)) continue;
    int finest = 0;
    while (set.contains(l + glm::ivec3(finest + 1, 0, 0))) ++finest;
    terms[finest] += slots(1, l.y) * slots(2, l.z);
  }
  int most = 0;
  for (const auto& [length, count] : terms) most = std::max(most, count);
  return 8.0 + most + double(terms.size());
}

double hb::latticeRoundings(const hbIndexSet& set, int row) {
  const double coarse = 1.0 + 5.0 + 2.0 * set.finest()[row] + 5.0, fine = 1.0 + 1.0 + 16.0 + 5.0;
  return std::max(coarse, fine) + 1.0;
}

double hb::directBound(const hbSparseGrid& grid, int component) {
  return directRoundings(grid.indexSet()) * 0x1p-24 * amplitude(grid, component) + coordinateBound(grid, component);
}

// No partial sum exceeds the amplitude: a line's values are sums of surpluses, each at most its subspace's largest.
double hb::semiNodalBound(const hbSparseGrid& grid, int component) {
  return semiNodalRoundings(grid.indexSet()) * 0x1p-24 * amplitude(grid, component) + coordinateBound(grid, component);
}

double hb::latticeBound(const hbSparseGrid& grid, int row, int component) {
  return latticeRoundings(grid.indexSet(), row) * 0x1p-24 * amplitude(grid, component);
}

double hb::combinationBound(const hbIndexSet& set, double largest) {
  return kCombinationRoundings * 0x1p-24 * amplification(set) * largest;
}

double hb::combinationBound(const hbCombinationSparseGrid& grid, double largest) {
  return kCombinationRoundings * 0x1p-24 * amplification(grid) * largest;
}
