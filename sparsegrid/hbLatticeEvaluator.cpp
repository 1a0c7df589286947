#include "sparsegrid/hbLatticeEvaluator.h"

#include <algorithm>
#include <cmath>

#include "sparsegrid/hbHat.h"

namespace {

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

double hbLatticeEvaluator::bytes(int size) const {
  double sums = 0.0, coarse = 0.0;
  const hbIndexSet& set = blocks_.grid().indexSet();
  for (int row = 0; row <= set.finest()[order().row]; ++row) {
    for (const std::size_t block : blocks_.besideRow(std::size_t(row)))
      sums += double(blocks_.block(block).nodesFast) * double(blocks_.block(block).nodesRow);
    if (row < blocks_.split()) coarse += double(hbIndexSet::axisNodes(set.flat()[order().row], row));
  }
  return sums * sizeof(double) + (coarse + 1.0) * double(rowStride(std::size_t(size))) * sizeof(float);
}

template <class Real>
void hbLatticeEvaluator::sumPlanes(const hbLatticePlanOf<Real>& plan, double w,
                                   hbLatticeWorkspaceOf<Real>& workspace) const {
  const bool slope = plan.quantity == Quantity::slopePlane;
  hbHat<double> hat;
  hat.evaluate(blocks_.place(w, order().plane), blocks_.flat(order().plane),
               blocks_.grid().indexSet().finest()[order().plane]);
  const double scale = blocks_.grid().latticeScale()[order().plane];
  workspace.sums.resize(std::max(workspace.sums.size(), std::size_t(plan.sums) + hbLatticeTableParts::kPastSums));
  std::vector<hbLatticeTerm>& terms = workspace.terms;
  for (const auto& window : plan.windows) {
    const hbLatticeBlocks::Block& block = blocks_.block(window.block);
    const std::int64_t plane = block.nodesFast * block.nodesRow;
    const std::int64_t first = window.firstRow * block.nodesFast + window.first;
    terms.clear();
    const auto add = [&](std::size_t level, std::size_t slot) {
      const double weight = slope ? hat.slope[slot] * scale : hat.weight[slot];
      if (weight != 0.0) terms.push_back({block.byLevel[level] + hat.node[slot] * plane + first, weight});
    };
    add(0, 0);
    if (!blocks_.flat(order().plane)) add(0, 1);
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
        lines.slope = Real(blocks_.grid().latticeScale()[order().fast] * std::ldexp(1.0, int(coarse.level)));
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
  const int axes[] = {-1, order().fast, order().row, order().plane};
  const Quantity quantity = plan.quantity;
  if (quantity != Quantity::value && blocks_.flat(axes[int(quantity)])) {
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
    rows.coarseSlope = Real(blocks_.grid().latticeScale()[order().row] * std::ldexp(1.0, int(plan.coarse.size()) - 1));
  if (quantity == Quantity::slopeFast)
    rows.tableSlope = Real(blocks_.grid().latticeScale()[order().fast] * double(hbLatticeTableParts::kTableCells));
  hb::latticeRows(rows, pastCaches ? aligned(workspace.buffer, rowStride(plan.size)) : nullptr, out, strideRow);
}

template void hbLatticeEvaluator::plane(const hbLatticePlan&, double, hbLatticeWorkspace&, float*, std::size_t,
                                        bool) const;
template void hbLatticeEvaluator::plane(const hbLatticePlan64&, double, hbLatticeWorkspace64&, double*, std::size_t,
                                        bool) const;
