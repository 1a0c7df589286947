#include "sparsegrid/hbLatticePlan.h"

#include <algorithm>
#include <cmath>

namespace {

/// The coarsest level whose nodes all of the places are; `finest` if some are between its nodes.
int levelOf(std::span<const double> places, int finest) {
  int level = 0;
  double cells = 1.0;
  for (const double place : places)
    while (level < finest && place * cells != std::nearbyint(place * cells)) {
      ++level;
      cells *= 2.0;
    }
  return level;
}

/// How many cells a level has.
double cellsOf(int level) { return double(std::int64_t{1} << level); }

/// The cell that holds u of [0,1]; 1 lies in the last one.
std::int32_t cellAt(double u, double cells) { return std::int32_t(std::min(u * cells, cells - 1.0)); }

template <class Cells>
std::vector<Cells> cellsWith(const std::vector<double>& places, int finest) {
  std::vector<Cells> result(std::size_t(finest) + 1);
  if (places.empty()) return result;
  const auto [least, greatest] = std::minmax_element(places.begin(), places.end());
  for (int level = 0; level <= finest; ++level)
    result[std::size_t(level)] = {cellAt(*least, cellsOf(level)), cellAt(*greatest, cellsOf(level)) + 1};
  return result;
}

} // namespace

template <class Real>
hbLatticePlanOf<Real>::hbLatticePlanOf(const hbLatticeBlocks& blocks, std::span<const double> us,
                                       std::span<const double> vs, hbLatticeQuantity wanted)
    : quantity(wanted), size(us.size()), rows(vs.size()) {
  const hbAxisOrder& order = blocks.order();
  std::vector<double> alongFast(us.size()), alongRow(vs.size());
  for (std::size_t i = 0; i < us.size(); ++i) alongFast[i] = blocks.place(us[i], order.fast);
  for (std::size_t j = 0; j < vs.size(); ++j) alongRow[j] = blocks.place(vs[j], order.row);
  // Hats of finer levels than that of the nodes vanish there; their slopes do not.
  const auto finest = [&](int axis, const std::vector<double>& at, hbLatticeQuantity slope) {
    const int level = blocks.grid().indexSet().finest()[axis];
    return quantity == slope ? level : levelOf(at, level);
  };
  const int finestFast = finest(order.fast, alongFast, hbLatticeQuantity::slopeFast);
  const int finestRow = finest(order.row, alongRow, hbLatticeQuantity::slopeRow);
  fast = cellsWith<Cells>(alongFast, finestFast);
  row = cellsWith<Cells>(alongRow, finestRow);
  const double nodes = cellsOf(finestFast);
  adjacent = quantity != hbLatticeQuantity::slopeFast && size > 0;
  for (std::size_t i = 0; i < size && adjacent; ++i)
    adjacent = alongFast[i] * nodes == std::nearbyint(alongFast[0] * nodes) + double(i);
  if (adjacent) firstNode = std::int64_t(alongFast[0] * nodes) - fast.back().begin;
  const int coarseLevels = std::min(blocks.split(), finestRow + 1);
  for (int level = 0; level < coarseLevels; ++level) addCoarse(blocks, level);
  if (coarseLevels <= finestRow) addFine(blocks, coarseLevels);
  placeAlongFast(alongFast);
  placeAlongRow(alongRow, blocks.grid().latticeScale()[order.row]);
}

template <class Real>
void hbLatticePlanOf<Real>::addWindow(std::size_t block, std::int64_t firstRow, std::int64_t windowRows,
                                      std::int64_t first, std::int64_t count) {
  windows.push_back({block, firstRow, windowRows, first, count, sums});
  sums += windowRows * count;
}

template <class Real>
void hbLatticePlanOf<Real>::addCoarse(const hbLatticeBlocks& blocks, int level) {
  // Level 0 has the ends; others the nodes from the first to the last coarse row needed of them, both included.
  const auto cells = row[std::size_t(level)];
  const std::int64_t firstRow = level == 0 ? 0 : cells.begin / 2;
  const std::int64_t lineCount =
      level == 0 ? hbIndexSet::axisNodes(blocks.flat(blocks.order().row), 0) : (cells.end - 1) / 2 - firstRow + 1;
  const std::vector<std::size_t>& beside = blocks.besideRow(std::size_t(level));
  CoarseLevel line{firstRow, lineCount, {}, 0};
  // Adjacent nodes are those of the finest level, up to which the line goes on without surpluses.
  line.level = (adjacent ? fast.size() : std::min(beside.size(), fast.size())) - 1;
  const std::int64_t ends = blocks.block(beside[0]).nodesFast;
  line.line.push_back({sums, ends, 0, 0});
  addWindow(beside[0], firstRow, lineCount, 0, ends);
  for (std::size_t f = 1; f <= line.level; ++f) {
    const auto parents = fast[f - 1]; // a surplus lies in the middle of a cell of the next coarser level
    const std::int64_t count = parents.end - parents.begin, shift = fast[f].begin - 2 * parents.begin;
    if (f >= beside.size()) {
      line.line.push_back({hbLatticeLineLevel::kNone, 0, count, shift});
      continue;
    }
    line.line.push_back({sums, count, count, shift});
    addWindow(beside[f], firstRow, lineCount, parents.begin, count);
  }
  coarse.push_back(std::move(line));
}

template <class Real>
void hbLatticePlanOf<Real>::addFine(const hbLatticeBlocks& blocks, int begin) {
  slots = row.size() - std::size_t(begin);
  const std::size_t levels = std::min(blocks.besideRow(std::size_t(begin)).size(), fast.size());
  for (std::size_t f = 0; f < levels; ++f) {
    hbLatticeTableParts::Level level{hbIndexSet::axisNodes(blocks.flat(blocks.order().fast), int(f)),
                                     parts.parts.size(), 0};
    for (std::size_t slot = 0; slot < slots; ++slot) {
      const std::vector<std::size_t>& beside = blocks.besideRow(std::size_t(begin) + slot);
      if (f >= beside.size()) break;
      const auto parents = row[std::size_t(begin) + slot - 1];
      parts.parts.push_back({slot, sums});
      addWindow(beside[f], parents.begin, parents.end - parents.begin, 0, level.count);
    }
    level.end = parts.parts.size();
    parts.levels.push_back(level);
  }
}

template <class Real>
void hbLatticePlanOf<Real>::placeAlongFast(const std::vector<double>& at) {
  places.resize(fast.size());
  for (const CoarseLevel& line : coarse) {
    const std::size_t level = line.level;
    Places& to = places[level];
    if (adjacent || !to.cell.empty()) continue;
    const double cells = cellsOf(int(level));
    const std::int32_t begin = fast[level].begin;
    to.cell.resize(size);
    to.step.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const std::int32_t cellOf = cellAt(at[i], cells);
      to.cell[i] = cellOf - begin;
      to.step[i] = Real(at[i] * cells - double(cellOf));
    }
  }
  if (slots == 0) return;
  const double cells = cellsOf(hbLatticeTableParts::kTableLevel);
  tableCell.resize(size);
  tableStep.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    tableCell[i] = cellAt(at[i], cells);
    tableStep[i] = Real(at[i] * cells - double(tableCell[i]));
  }
}

template <class Real>
void hbLatticePlanOf<Real>::placeAlongRow(const std::vector<double>& at, double scale) {
  const std::size_t begin = coarse.size();
  const double coarseCells = cellsOf(int(begin) - 1);
  cell.resize(rows);
  step.resize(rows);
  node.resize(rows * slots);
  weight.resize(rows * slots);
  for (std::size_t j = 0; j < rows; ++j) {
    const std::int32_t cellOf = cellAt(at[j], coarseCells);
    cell[j] = cellOf - row[begin - 1].begin;
    step[j] = Real(at[j] * coarseCells - double(cellOf));
    double parents = coarseCells; // a level's nodes lie in the middle of the cells of the next coarser one
    for (std::size_t slot = 0; slot < slots; ++slot, parents *= 2.0) {
      const std::size_t to = j * slots + slot;
      const std::int32_t nodeOf = cellAt(at[j], parents);
      const double t = at[j] * 2.0 * parents - double(2 * nodeOf + 1); // as hbHat has it
      node[to] = nodeOf - row[begin + slot - 1].begin;
      weight[to] =
          quantity == hbLatticeQuantity::slopeRow ? (t >= 0.0 ? -2.0 : 2.0) * parents * scale : 1.0 - std::abs(t);
    }
  }
}

template struct hbLatticePlanOf<float>;
template struct hbLatticePlanOf<double>;
