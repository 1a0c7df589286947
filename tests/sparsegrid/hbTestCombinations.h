#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <glm/vector_relational.hpp>

#include "sparsegrid/hbSparseGrid.h"

/// Combinations with other coefficients than those of interpolation, as tests share them.
namespace hbTestCombinations {

/// A number for each component grid, off from that of interpolation by up to 0.5, times `scale`.
inline std::vector<double> coefficients(const hbIndexSet& set, double scale, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-0.5, 0.5);
  std::vector<double> list;
  for (const auto& one : set.componentGrids()) list.push_back(scale * (one.coefficient + off(random)));
  return list;
}

/// The sparse grid that the combination of the component grids of `grid` is, its surpluses rounded to 32 bits.
inline hbSparseGrid scaledBy(const hbSparseGrid& grid, std::span<const double> coefficients) {
  const hbIndexSet& set = grid.indexSet();
  const auto grids = set.componentGrids();
  std::vector<std::vector<float>> surpluses(static_cast<std::size_t>(grid.components()));
  for (int c = 0; c < grid.components(); ++c)
    for (const hbSubspace& subspace : set.subspaces()) {
      double sum = 0.0;
      for (std::size_t l = 0; l < grids.size(); ++l)
        if (glm::all(glm::lessThanEqual(subspace.levels, grids[l].levels))) sum += coefficients[l];
      for (const float s : grid.surpluses(subspace, c)) surpluses[std::size_t(c)].push_back(float(sum * double(s)));
    }
  return hbSparseGrid::fromSurpluses(grid.frame(), set, std::move(surpluses));
}

} // namespace hbTestCombinations
