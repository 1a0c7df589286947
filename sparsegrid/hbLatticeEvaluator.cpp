#include "sparsegrid/hbLatticeEvaluator.h"

#include <algorithm>
#include <cmath>

namespace {

/// The coarsest level whose nodes all of the places are; `finest` if some are between its nodes.
int levelOf(const std::vector<double>& places, int finest) {
  int level = 0;
  for (const double place : places)
    while (level < finest && std::ldexp(place, level) != std::nearbyint(std::ldexp(place, level))) ++level;
  return level;
}

} // namespace

hbLatticeEvaluator::hbLatticeEvaluator(const hbSparseGrid& grid, int component, std::span<const double> xs,
                                       std::span<const double> ys)
    : grid_(grid), sizeX_(xs.size()) {
  const hbIndexSet& set = grid.indexSet();
  std::vector<double> u;
  for (const double x : xs) u.push_back(grid.latticeCoordinate(x, 0));
  // Finer hats vanish at the nodes of that level.
  const int finest = set.flat().x ? 0 : levelOf(u, set.finest().x);

  for (int lx = 0; lx <= finest; ++lx) {
    hbLatticeRows::Level level{hbIndexSet::axisNodes(set.flat().x, lx), rows_.parts.size(), 0};
    for (int ly = 0; set.contains({lx, ly, 0}); ++ly) {
      const hbSubspace& base = set.subspace({lx, ly, 0});
      Column column{base.nodes.x * base.nodes.y, planeSize_, {}};
      for (int lz = 0; set.contains({lx, ly, lz}); ++lz)
        column.byLevel.push_back(grid.surpluses(set.subspace({lx, ly, lz}), component).data());
      columns_.push_back(std::move(column));
      const int slots = ly > 0 || set.flat().y ? 1 : 2;
      for (int s = 0; s < slots; ++s) rows_.parts.push_back({ly > 0 ? ly + 1 : s, planeSize_});
      planeSize_ += base.nodes.x * base.nodes.y;
    }
    level.end = rows_.parts.size();
    rows_.levels.push_back(level);
  }
  for (const double y : ys) hatsY_.push_back(hat(y, 1));

  const std::int64_t cells = set.flat().x ? 0 : std::int64_t{1} << finest;
  bool adjacent = true;
  for (const double x : u) {
    const double place = x * double(cells);
    const std::int64_t cell = std::clamp<std::int64_t>(std::int64_t(place), 0, std::max<std::int64_t>(cells - 1, 0));
    places_.push_back({cell, place - double(cell)});
    const std::int64_t node = places_.front().cell + std::int64_t(places_.front().t) + std::int64_t(places_.size()) - 1;
    adjacent = adjacent && place == double(node);
  }
  if (!adjacent || places_.empty()) return;
  firstNode_ = places_.front().cell + std::int64_t(places_.front().t);
  places_.clear();
}

hbHat<double> hbLatticeEvaluator::hat(double coordinate, int axis) const {
  hbHat<double> result;
  result.evaluate(grid_.latticeCoordinate(coordinate, axis), grid_.indexSet().flat()[axis],
                  grid_.indexSet().finest()[axis]);
  return result;
}

void hbLatticeEvaluator::plane(double z, float* out, std::size_t strideY) const {
  const hbHat<double> hatZ = hat(z, 2);
  const bool flatZ = grid_.indexSet().flat().z;
  std::vector<double> sums(std::size_t(planeSize_), 0.0);
  for (const Column& column : columns_) {
    const auto add = [&](std::size_t slot, const float* surpluses) {
      if (hatZ.weight[slot] != 0.0)
        hb::addWeighted(surpluses + hatZ.node[slot] * column.count, column.count, hatZ.weight[slot],
                        sums.data() + column.offset);
    };
    add(0, column.byLevel[0]);
    if (!flatZ) add(1, column.byLevel[0]);
    for (std::size_t l = 1; l < column.byLevel.size(); ++l) add(l + 1, column.byLevel[l]);
  }

  const std::size_t line = (std::size_t{1} << (rows_.levels.size() - 1)) + 1;
  std::vector<double> surpluses(line), scratch(2 * line);
  for (std::size_t j = 0; j < hatsY_.size(); ++j) {
    const double* row = hb::latticeRow(rows_, sums.data(), hatsY_[j].node, hatsY_[j].weight, surpluses, scratch);
    float* to = out + j * strideY;
    if (places_.empty()) {
      hb::roundToFloats(row + firstNode_, std::int64_t(sizeX_), to);
      continue;
    }
    const std::int64_t step = grid_.indexSet().flat().x ? 0 : 1;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const auto& [cell, t] = places_[i];
      to[i] = float(row[cell] + t * (row[cell + step] - row[cell]));
    }
  }
}
