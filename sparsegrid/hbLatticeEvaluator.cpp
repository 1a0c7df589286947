#include "sparsegrid/hbLatticeEvaluator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "sparsegrid/hbHat.h"

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

/// What a lattice costs, in nanoseconds on the processor of doc/results.md; only the ratios matter.
constexpr double kSurplus = 0.1;      ///< added up for a plane,
constexpr double kNode = 0.3;         ///< dehierarchised of a coarse line,
constexpr double kCoarseSample = 0.5; ///< of a coarse row,
constexpr double kRow = 40.0;         ///< a table,
constexpr double kSample = 0.15;      ///< a sample from it,
constexpr double kScattered = 2.0;    ///< and to a place of its own; and
constexpr double kReordered = 3.0;    ///< a surplus copied.

glm::ivec3 levelsOf(const hbAxisOrder& order, int fast, int row, int plane) {
  glm::ivec3 result(0);
  result[order.fast] = fast;
  result[order.row] = row;
  result[order.plane] = plane;
  return result;
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

/// Room for a row, so that rows begin where vectors do.
constexpr std::size_t kRowUnit = 16;
std::size_t rowStride(std::size_t size) { return (size + kRowUnit - 1) / kRowUnit * kRowUnit; }

template <class Real>
Real* aligned(std::vector<Real>& memory, std::size_t size) {
  memory.resize(std::max(memory.size(), size + kRowUnit));
  const std::size_t past = reinterpret_cast<std::uintptr_t>(memory.data()) / sizeof(Real) % kRowUnit;
  return memory.data() + (kRowUnit - past) % kRowUnit;
}

} // namespace

hbLatticeEvaluator::hbLatticeEvaluator(const hbSparseGrid& grid, int component, const hbAxisOrder& order)
    : grid_(grid), order_(order) {
  const hbIndexSet& set = grid.indexSet();
  if (order != hbAxisOrder{}) reorder(component);
  // Reordered subspaces lie as they do in the grid.
  const float* surpluses = order == hbAxisOrder{} ? grid.surpluses(component).data() : reordered_.data();
  for (int row = 0; set.contains(levelsOf(order, 0, row, 0)); ++row) {
    blockAt_.emplace_back();
    for (int fast = 0; set.contains(levelsOf(order, fast, row, 0)); ++fast) {
      const hbSubspace& base = set.subspace(levelsOf(order, fast, row, 0));
      Block block{base.nodes[order.fast], base.nodes[order.row], {}};
      for (int plane = 0; set.contains(levelsOf(order, fast, row, plane)); ++plane)
        block.byLevel.push_back(surpluses + set.subspace(levelsOf(order, fast, row, plane)).offset);
      blockAt_.back().push_back(blocks_.size());
      blocks_.push_back(std::move(block));
    }
    if (int(blockAt_.back().size()) > hbLatticeParts::kTableLevel + 1) split_ = row + 1;
  }
}

hbAxisOrder hbLatticeEvaluator::cheapestOrder(const hbIndexSet& set, const hbSize3& samples) {
  const hbAxisOrder natural;
  const auto cost = [&](const hbAxisOrder& order) {
    const auto size = [&](int axis) { return double(samples[axis]); };
    double sums = 0.0, coarse = 0.0, fine = size(order.row) * kRow;
    for (int row = 0; set.contains(levelsOf(order, 0, row, 0)); ++row) {
      int fast = 0;
      double rows = 0.0;
      for (; set.contains(levelsOf(order, fast, row, 0)); ++fast) {
        int plane = 0;
        while (set.contains(levelsOf(order, fast, row, plane))) ++plane;
        const hbSize3 nodes = set.subspace(levelsOf(order, fast, row, 0)).nodes;
        rows = double(nodes[order.row]);
        sums += double(nodes[order.fast]) * rows * double(plane) * kSurplus;
      }
      if (fast - 1 > hbLatticeParts::kTableLevel || row == 0)
        coarse += rows * (std::exp2(fast) * kNode + size(order.fast) * kCoarseSample);
    }
    const double each = order.fast == natural.fast ? kSample : kSample + kScattered;
    return size(order.plane) * (sums + coarse + fine + size(order.row) * size(order.fast) * each) +
           (order == natural ? 0.0 : double(set.storedValues()) * kReordered);
  };
  hbAxisOrder best = natural;
  double least = 0.5 * cost(natural);
  for (const hbAxisOrder& order :
       {hbAxisOrder{0, 2, 1}, hbAxisOrder{1, 0, 2}, hbAxisOrder{1, 2, 0}, hbAxisOrder{2, 0, 1}, hbAxisOrder{2, 1, 0}})
    if (const double found = cost(order); found < least) {
      best = order;
      least = found;
    }
  return best;
}

double hbLatticeEvaluator::place(double coordinate, int axis) const {
  if (grid_.frame().mapping == hbLatticeMapping::fitted || flat(axis)) return grid_.latticeCoordinate(coordinate, axis);
  const double cells = double(grid_.geometry().size[axis] - 1);
  const double sample = std::nearbyint(coordinate * cells);
  const bool isSample = std::abs(coordinate * cells - sample) <= 0x1p-52 * cells;
  return isSample && sample >= 0.0 && sample <= cells ? sample * (grid_.latticeScale()[axis] / cells)
                                                      : grid_.latticeCoordinate(coordinate, axis);
}

void hbLatticeEvaluator::reorder(int component) {
  const auto from = grid_.surpluses(component);
  reordered_.resize(from.size());
  for (const hbSubspace& subspace : grid_.indexSet().subspaces()) {
    const hbSize3 nodes = subspace.nodes;
    const std::int64_t strides[] = {1, nodes.x, nodes.x * nodes.y};
    float* to = reordered_.data() + subspace.offset;
    for (std::int64_t k = 0; k < nodes[order_.plane]; ++k)
      for (std::int64_t j = 0; j < nodes[order_.row]; ++j)
        for (std::int64_t i = 0; i < nodes[order_.fast]; ++i)
          *to++ = from[std::size_t(subspace.offset + i * strides[order_.fast] + j * strides[order_.row] +
                                   k * strides[order_.plane])];
  }
}

template <class Real>
hbLatticePlanOf<Real> hbLatticeEvaluator::planOf(std::span<const double> us, std::span<const double> vs,
                                                 Quantity quantity) const {
  using Plan = hbLatticePlanOf<Real>;
  Plan plan;
  plan.quantity = quantity;
  plan.size = us.size();
  plan.rows = vs.size();
  std::vector<double> fast(us.size()), row(vs.size());
  for (std::size_t i = 0; i < us.size(); ++i) fast[i] = place(us[i], order_.fast);
  for (std::size_t j = 0; j < vs.size(); ++j) row[j] = place(vs[j], order_.row);
  // Hats of finer levels than that of the nodes vanish there; their slopes do not.
  const auto finest = [&](int axis, const std::vector<double>& places, Quantity slope) {
    const int level = grid_.indexSet().finest()[axis];
    return quantity == slope ? level : levelOf(places, level);
  };
  const int finestFast = finest(order_.fast, fast, Quantity::slopeFast);
  const int finestRow = finest(order_.row, row, Quantity::slopeRow);
  plan.fast = cellsWith<typename Plan::Cells>(fast, finestFast);
  plan.row = cellsWith<typename Plan::Cells>(row, finestRow);
  const double nodes = cellsOf(finestFast);
  plan.adjacent = quantity != Quantity::slopeFast && !fast.empty();
  for (std::size_t i = 0; i < fast.size() && plan.adjacent; ++i)
    plan.adjacent = fast[i] * nodes == std::nearbyint(fast[0] * nodes) + double(i);
  if (plan.adjacent) plan.firstNode = std::int64_t(fast[0] * nodes) - plan.fast.back().begin;
  const int coarseLevels = std::min(split_, finestRow + 1);
  for (int level = 0; level < coarseLevels; ++level) addCoarse(plan, level);
  if (coarseLevels <= finestRow) addFine(plan, coarseLevels);
  placeAlongFast(plan, fast);
  placeAlongRow(plan, row);
  return plan;
}

template <class Real>
void hbLatticeEvaluator::addWindow(hbLatticePlanOf<Real>& plan, std::size_t block, std::int64_t firstRow,
                                   std::int64_t rows, std::int64_t first, std::int64_t count) const {
  plan.windows.push_back({block, firstRow, rows, first, count, plan.sums});
  plan.sums += rows * count;
}

template <class Real>
void hbLatticeEvaluator::addCoarse(hbLatticePlanOf<Real>& plan, int level) const {
  // Level 0 has the ends; others the nodes from the first to the last coarse row needed of them, both included.
  const auto cells = plan.row[std::size_t(level)];
  const std::int64_t firstRow = level == 0 ? 0 : cells.begin / 2;
  const std::int64_t rows =
      level == 0 ? hbIndexSet::axisNodes(flat(order_.row), 0) : (cells.end - 1) / 2 - firstRow + 1;
  const std::vector<std::size_t>& blocks = blockAt_[std::size_t(level)];
  typename hbLatticePlanOf<Real>::CoarseLevel coarse{firstRow, rows, {}, 0};
  // Adjacent nodes are those of the finest level, up to which the line goes on without surpluses.
  coarse.level = plan.adjacent ? plan.fast.size() - 1 : std::min(blocks.size(), plan.fast.size()) - 1;
  const std::int64_t ends = blocks_[blocks[0]].nodesFast;
  coarse.line.push_back({plan.sums, ends, 0, 0});
  addWindow(plan, blocks[0], firstRow, rows, 0, ends);
  for (std::size_t f = 1; f <= coarse.level; ++f) {
    const auto parents = plan.fast[f - 1]; // a surplus lies in the middle of a cell of the next coarser level
    const std::int64_t count = parents.end - parents.begin, shift = plan.fast[f].begin - 2 * parents.begin;
    if (f >= blocks.size()) {
      coarse.line.push_back({hbLatticeLineLevel::kNone, 0, count, shift});
      continue;
    }
    coarse.line.push_back({plan.sums, count, count, shift});
    addWindow(plan, blocks[f], firstRow, rows, parents.begin, count);
  }
  plan.coarse.push_back(std::move(coarse));
}

template <class Real>
void hbLatticeEvaluator::addFine(hbLatticePlanOf<Real>& plan, int begin) const {
  plan.slots = plan.row.size() - std::size_t(begin);
  const std::size_t levels = std::min(blockAt_[std::size_t(begin)].size(), plan.fast.size());
  for (std::size_t f = 0; f < levels; ++f) {
    hbLatticeParts::Level level{hbIndexSet::axisNodes(flat(order_.fast), int(f)), plan.parts.parts.size(), 0};
    for (std::size_t slot = 0; slot < plan.slots; ++slot) {
      const std::vector<std::size_t>& blocks = blockAt_[std::size_t(begin) + slot];
      if (f >= blocks.size()) break;
      const auto parents = plan.row[std::size_t(begin) + slot - 1];
      plan.parts.parts.push_back({slot, plan.sums});
      addWindow(plan, blocks[f], parents.begin, parents.end - parents.begin, 0, level.count);
    }
    level.end = plan.parts.parts.size();
    plan.parts.levels.push_back(level);
  }
}

template <class Real>
void hbLatticeEvaluator::placeAlongFast(hbLatticePlanOf<Real>& plan, const std::vector<double>& places) const {
  const std::size_t size = places.size();
  plan.places.resize(plan.fast.size());
  for (const auto& coarse : plan.coarse) {
    const std::size_t level = coarse.level;
    auto& [cell, step] = plan.places[level];
    if (plan.adjacent || !cell.empty()) continue;
    const double cells = cellsOf(int(level));
    const std::int32_t begin = plan.fast[level].begin;
    cell.resize(size);
    step.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const std::int32_t at = cellAt(places[i], cells);
      cell[i] = at - begin;
      step[i] = Real(places[i] * cells - double(at));
    }
  }
  if (plan.slots == 0) return;
  const double cells = cellsOf(hbLatticeParts::kTableLevel);
  plan.tableCell.resize(size);
  plan.tableStep.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    plan.tableCell[i] = cellAt(places[i], cells);
    plan.tableStep[i] = Real(places[i] * cells - double(plan.tableCell[i]));
  }
}

template <class Real>
void hbLatticeEvaluator::placeAlongRow(hbLatticePlanOf<Real>& plan, const std::vector<double>& places) const {
  const std::size_t size = places.size(), begin = plan.coarse.size();
  const double coarse = cellsOf(int(begin) - 1), scale = grid_.latticeScale()[order_.row];
  plan.cell.resize(size);
  plan.step.resize(size);
  plan.node.resize(size * plan.slots);
  plan.weight.resize(size * plan.slots);
  for (std::size_t j = 0; j < size; ++j) {
    const std::int32_t cell = cellAt(places[j], coarse);
    plan.cell[j] = cell - plan.row[begin - 1].begin;
    plan.step[j] = Real(places[j] * coarse - double(cell));
    double parents = coarse; // a level's nodes lie in the middle of the cells of the next coarser one
    for (std::size_t slot = 0; slot < plan.slots; ++slot, parents *= 2.0) {
      const std::size_t at = j * plan.slots + slot;
      const std::int32_t node = cellAt(places[j], parents);
      const double t = places[j] * 2.0 * parents - double(2 * node + 1); // as hbHat has it
      plan.node[at] = node - plan.row[begin + slot - 1].begin;
      plan.weight[at] =
          plan.quantity == Quantity::slopeRow ? (t >= 0.0 ? -2.0 : 2.0) * parents * scale : 1.0 - std::abs(t);
    }
  }
}

template <class Real>
void hbLatticeEvaluator::sumPlanes(const hbLatticePlanOf<Real>& plan, double w,
                                   hbLatticeWorkspaceOf<Real>& workspace) const {
  const bool slope = plan.quantity == Quantity::slopePlane;
  hbHat<double> hat;
  hat.evaluate(place(w, order_.plane), flat(order_.plane), grid_.indexSet().finest()[order_.plane]);
  const double scale = grid_.latticeScale()[order_.plane];
  workspace.sums.resize(std::max(workspace.sums.size(), std::size_t(plan.sums) + hbLatticeParts::kPastSums));
  std::vector<hbLatticeTerm>& terms = workspace.terms;
  for (const auto& window : plan.windows) {
    const Block& block = blocks_[window.block];
    const std::int64_t plane = block.nodesFast * block.nodesRow;
    const std::int64_t first = window.firstRow * block.nodesFast + window.first;
    terms.clear();
    const auto add = [&](std::size_t level, std::size_t slot) {
      const double weight = slope ? hat.slope[slot] * scale : hat.weight[slot];
      if (weight != 0.0) terms.push_back({block.byLevel[level] + hat.node[slot] * plane + first, weight});
    };
    add(0, 0);
    if (!flat(order_.plane)) add(0, 1);
    for (std::size_t level = 1; level < block.byLevel.size(); ++level) add(level, level + 1);
    double* sum = workspace.sums.data() + window.offset;
    if (window.count == block.nodesFast) {
      hb::weightedSum(terms, window.rows * window.count, sum);
      continue;
    }
    for (std::int64_t row = 0; row < window.rows; ++row) {
      hb::weightedSum(terms, window.count, sum + row * window.count);
      for (hbLatticeTerm& term : terms) term.surpluses += block.nodesFast;
    }
  }
}

template <class Real>
void hbLatticeEvaluator::coarseRows(const hbLatticePlanOf<Real>& plan, hbLatticeWorkspaceOf<Real>& workspace) const {
  const std::size_t stride = rowStride(plan.size);
  std::int64_t count = 0;
  for (const auto& coarse : plan.coarse) count += coarse.rows;
  Real* next = aligned(workspace.coarse, std::size_t(count) * stride);
  std::size_t longest = 2;
  for (const auto& cells : plan.fast) longest = std::max(longest, std::size_t(2 * (cells.end - cells.begin) + 1));
  for (auto* line : {&workspace.line, &workspace.finer}) line->resize(std::max(line->size(), longest));
  workspace.rounded.resize(workspace.line.size());

  hbLatticeLinesOf<Real> lines;
  lines.sums = workspace.sums.data();
  lines.line = workspace.line.data();
  lines.finer = workspace.finer.data();
  lines.rounded = workspace.rounded.data();
  lines.size = plan.size;
  lines.firstNode = plan.firstNode;
  std::vector<Real*>&rows = workspace.rows, &finer = workspace.finerRows;
  rows.clear();
  for (std::size_t l = 0; l < plan.coarse.size(); ++l) {
    const auto& coarse = plan.coarse[l];
    const auto cells = plan.fast[coarse.level];
    lines.levels = coarse.line;
    lines.cells = cells.end - cells.begin;
    if (!plan.adjacent) {
      lines.cell = plan.places[coarse.level].cell.data();
      lines.step = plan.places[coarse.level].step.data();
      if (plan.quantity == Quantity::slopeFast)
        lines.slope = Real(grid_.latticeScale()[order_.fast] * cellsOf(int(coarse.level)));
    }
    Real* first = next;
    next += std::size_t(coarse.rows) * stride;
    hb::coarseRows(lines, coarse.rows, first, stride);
    if (l == 0) {
      rows = {first, coarse.rows == 1 ? first : first + stride};
      continue;
    }
    const auto &from = plan.row[l - 1], &to = plan.row[l];
    finer.clear();
    for (std::int64_t node = to.begin; node <= to.end; ++node) {
      Real* const before = rows[std::size_t(node / 2 - from.begin)];
      if (node % 2 == 0) {
        finer.push_back(before);
        continue;
      }
      Real* row = first + std::size_t(node / 2 - coarse.firstRow) * stride;
      hb::addMean(before, rows[std::size_t(node / 2 - from.begin + 1)], plan.size, row);
      finer.push_back(row);
    }
    std::swap(rows, finer);
  }
}

template <class Real>
void hbLatticeEvaluator::plane(const hbLatticePlanOf<Real>& plan, double w, hbLatticeWorkspaceOf<Real>& workspace,
                               Real* out, std::size_t strideRow, bool pastCaches) const {
  const int axes[] = {-1, order_.fast, order_.row, order_.plane};
  const Quantity quantity = plan.quantity;
  if (quantity != Quantity::value && flat(axes[int(quantity)])) {
    for (std::size_t j = 0; j < plan.rows; ++j) std::fill_n(out + j * strideRow, plan.size, Real(0));
    return;
  }
  if (plan.size == 0 || plan.rows == 0) return;
  sumPlanes(plan, w, workspace);
  coarseRows(plan, workspace);

  hbLatticeRowsOf<Real> rows;
  rows.size = plan.size;
  rows.count = plan.rows;
  rows.coarse = workspace.rows.data();
  rows.coarseCell = plan.cell.data();
  rows.coarseStep = plan.step.data();
  rows.parts = &plan.parts;
  rows.sums = workspace.sums.data();
  rows.slots = plan.slots;
  rows.node = plan.node.data();
  rows.weight = plan.weight.data();
  rows.cell = plan.tableCell.data();
  rows.step = plan.tableStep.data();
  if (quantity == Quantity::slopeRow)
    rows.coarseSlope = Real(grid_.latticeScale()[order_.row] * cellsOf(int(plan.coarse.size()) - 1));
  if (quantity == Quantity::slopeFast)
    rows.tableSlope = Real(grid_.latticeScale()[order_.fast] * cellsOf(hbLatticeParts::kTableLevel));
  hb::latticeRows(rows, pastCaches ? aligned(workspace.buffer, rowStride(plan.size)) : nullptr, out, strideRow);
}

template hbLatticePlan hbLatticeEvaluator::planOf(std::span<const double>, std::span<const double>, Quantity) const;
template hbLatticePlan64 hbLatticeEvaluator::planOf(std::span<const double>, std::span<const double>, Quantity) const;
template void hbLatticeEvaluator::plane(const hbLatticePlan&, double, hbLatticeWorkspace&, float*, std::size_t,
                                        bool) const;
template void hbLatticeEvaluator::plane(const hbLatticePlan64&, double, hbLatticeWorkspace64&, double*, std::size_t,
                                        bool) const;
