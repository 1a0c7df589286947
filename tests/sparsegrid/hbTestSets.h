#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <vector>

#include <glm/vector_relational.hpp>
#include <rapidcheck.h>

#include "sparsegrid/hbSparseGrid.h"

/// Random index sets, and the references and bounds the sparse-grid tests share.
namespace hbTestSets {

/// Axes with any mixture of flat, two-node and refined ones up to level 5.
inline rc::Gen<hbIndexSet::Axes> axes() {
  return rc::gen::map(rc::gen::container<std::vector<int>>(3, rc::gen::inRange(-1, 6)),
                      [](const std::vector<int>& kinds) {
                        hbIndexSet::Axes axes;
                        for (int d = 0; d < 3; ++d) {
                          axes.flat[d] = kinds[std::size_t(d)] < 0;
                          axes.maxLevel[d] = std::max(kinds[std::size_t(d)], 0);
                        }
                        return axes;
                      });
}

/// A regular, capped, anisotropic or full set.
inline rc::Gen<hbIndexSet> any() {
  return rc::gen::map(
      rc::gen::pair(axes(), rc::gen::inRange(0, 8)), [](const std::pair<hbIndexSet::Axes, int>& choice) {
        return choice.second == 0 ? hbIndexSet::full(choice.first) : hbIndexSet::regular(choice.second, choice.first);
      });
}

/// The size of a volume whose lattice the set's axes are: 1 where flat, 2 where coarse, 2^l + 1.
inline hbSize3 sizeOf(const hbIndexSet& set) {
  hbSize3 size;
  for (int d = 0; d < 3; ++d) size[d] = set.flat()[d] ? 1 : (std::int64_t{1} << set.finest()[d]) + 1;
  return size;
}

/// Sum over the subspaces of the largest surplus: no partial sum of an evaluation exceeds it, as the weights of the
/// basis functions of one subspace sum to at most 1.
inline double amplitude(const hbSparseGrid& grid, int component = 0) {
  double sum = 0.0;
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) {
    float largest = 0.0F;
    for (const float s : grid.surpluses(subspace, component)) largest = std::max(largest, std::abs(s));
    sum += largest;
  }
  return sum;
}

/// With the aligned mapping, the lattice coordinate of a point is rounded to 32 bits, by 2^-25 at most, before the
/// weights are taken; they change by the slope 2^l of their hats. 0 with the fitted mapping: the coordinates are the
/// points' own.
inline double coordinateBound(const hbSparseGrid& grid, int component = 0) {
  if (grid.latticeScale() == glm::dvec3(1.0)) return 0.0;
  double sum = 0.0;
  for (const hbSubspace& subspace : grid.indexSet().subspaces()) {
    float largest = 0.0F;
    for (const float s : grid.surpluses(subspace, component)) largest = std::max(largest, std::abs(s));
    for (int d = 0; d < 3; ++d) sum += std::exp2(subspace.levels[d]) * 0x1p-25 * largest;
  }
  return sum;
}

/// Rounding of the direct engine in 32 bits: three weights and their two products, the product with the surplus, the
/// surplus itself, and the additions over lx; the rest is in 64 bits; once more at the end.
inline double directBound(const hbSparseGrid& grid, int component = 0) {
  return (9.0 + grid.indexSet().finest().x) * 0x1p-24 * amplitude(grid, component) + coordinateBound(grid, component);
}

/// Rounding of the semi-nodal engine in 32 bits: the stored value; the weights of y and z, their product and that with
/// the value; the additions of the lines of one length; the weight of x and its product; the additions over the
/// lengths; the sum of the two nodes along x. No partial sum exceeds the amplitude: a line's values are sums of
/// surpluses, each at most its subspace's largest.
inline double semiNodalBound(const hbSparseGrid& grid, int component = 0) {
  const hbIndexSet& set = grid.indexSet();
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
  return (8.0 + most + double(terms.size())) * 0x1p-24 * amplitude(grid, component) + coordinateBound(grid, component);
}

/// Rounding of lattices in 32 bits, see hbLatticeEvaluator; `row` is the axis along which rows follow each other. An
/// interpolation (1 - t) a + t b rounds t (which moves the result by twice a rounding, as b - a is up to twice the
/// amplitude), 1 - t, the two products (together one) and their sum: 5. A coarse row: its line and an interpolation
/// between the line's nodes. Each level of the row axis adds a mean and a sum, then there is an interpolation between
/// two coarse rows. The table: its hierarchical values, the products with their weights and 16 additions, then an
/// interpolation. Each part is that of its own share of the amplitude; in the end they are added.
inline double latticeBound(const hbSparseGrid& grid, int row = 1, int component = 0) {
  const double coarse = 1.0 + 5.0 + 2.0 * grid.indexSet().finest()[row] + 5.0, fine = 1.0 + 1.0 + 16.0 + 5.0;
  return (std::max(coarse, fine) + 1.0) * 0x1p-24 * amplitude(grid, component);
}

/// Rounding of the combination in 32 bits: the nodal value; in each of three lerps a + t (b - a) a difference and a
/// product of up to twice the `largest` nodal value and a sum of up to once that, so 5; the product with the
/// coefficient, and the result. The coordinates' rounding comes on top (coordinateBound).
inline double combinationBound(const hbIndexSet& set, double largest) {
  double coefficients = 0.0;
  for (const auto& grid : set.componentGrids()) coefficients += std::abs(grid.coefficient);
  return 18.0 * 0x1p-24 * coefficients * largest;
}

} // namespace hbTestSets
