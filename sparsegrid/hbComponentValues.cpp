#include "sparsegrid/hbComponentValues.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace {

/// The cell of a point along an axis: its lower node, and the place inside.
struct Cell {
  std::int64_t index = 0;
  double t = 0.0;

  Cell(double place, std::int64_t nodes) {
    const double position = place * double(nodes - 1);
    index = std::min(std::int64_t(position), std::max<std::int64_t>(nodes - 2, 0));
    t = position - double(index);
  }
};

hbComponentValue valueOf(const hbCombinationSparseGrid& combination, const hbCombinationSparseGrid::Grid& grid,
                         const glm::dvec3& place, int component) {
  const auto values = combination.values(grid, component);
  const std::array<Cell, 3> cells{Cell(place.x, grid.nodes.x), Cell(place.y, grid.nodes.y),
                                  Cell(place.z, grid.nodes.z)};
  const auto weight = [&](int d, std::int64_t i) {
    const Cell& cell = cells[std::size_t(d)];
    return i == cell.index ? 1.0 - cell.t : i == cell.index + 1 ? cell.t : 0.0;
  };
  const auto first = [&](int d) { return std::max<std::int64_t>(cells[std::size_t(d)].index - 1, 0); };
  const auto last = [&](int d) { return std::min(cells[std::size_t(d)].index + 2, grid.nodes[d] - 1); };
  hbComponentValue found{&grid};
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (std::int64_t k = first(2); k <= last(2); ++k)
    for (std::int64_t j = first(1); j <= last(1); ++j)
      for (std::int64_t i = first(0); i <= last(0); ++i) {
        const double v = double(values[std::size_t(i + grid.nodes.x * (j + grid.nodes.y * k))]);
        found.value += weight(0, i) * weight(1, j) * weight(2, k) * v;
        least = std::min(least, v);
        greatest = std::max(greatest, v);
      }
  found.largest = std::max(std::abs(least), std::abs(greatest));
  found.range = greatest - least;
  return found;
}

} // namespace

std::vector<hbComponentValue> hb::componentValues(const hbCombinationSparseGrid& grid, const glm::dvec3& point,
                                                  int component) {
  const glm::dvec3 scale = grid.latticeScale();
  glm::dvec3 place;
  for (int d = 0; d < 3; ++d) place[d] = scale[d] * std::clamp(point[d], 0.0, 1.0);
  std::vector<hbComponentValue> list;
  for (const hbCombinationSparseGrid::Grid& one : grid.grids()) list.push_back(valueOf(grid, one, place, component));
  return list;
}
