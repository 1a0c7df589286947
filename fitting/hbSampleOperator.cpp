#include "fitting/hbSampleOperator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "volume/hbParallel.h"

namespace {

/// Where level l begins in a line of surpluses that has level after level.
std::int64_t lineOffset(int level) { return level == 0 ? 0 : (std::int64_t{1} << (level - 1)) + 1; }

/// From surpluses, level after level, to values at the nodes in their order; all three have 2^finest + 1 elements.
void dehierarchiseLine(const double* surpluses, int finest, std::vector<double>& nodal, std::vector<double>& finer) {
  nodal[0] = surpluses[0];
  nodal[1] = surpluses[1];
  for (int l = 1; l <= finest; ++l) {
    const double* own = surpluses + lineOffset(l);
    const std::int64_t cells = std::int64_t{1} << (l - 1);
    for (std::int64_t k = 0; k < cells; ++k) {
      finer[std::size_t(2 * k)] = nodal[std::size_t(k)];
      finer[std::size_t(2 * k + 1)] = own[k] + 0.5 * (nodal[std::size_t(k)] + nodal[std::size_t(k + 1)]);
    }
    finer[std::size_t(2 * cells)] = nodal[std::size_t(cells)];
    std::swap(nodal, finer);
  }
}

/// Its transpose; `nodal` is lost.
void transposedLine(std::vector<double>& nodal, std::vector<double>& coarser, int finest, double* surpluses) {
  for (int l = finest; l >= 1; --l) {
    double* own = surpluses + lineOffset(l);
    const std::int64_t cells = std::int64_t{1} << (l - 1);
    coarser[0] = nodal[0];
    for (std::int64_t k = 0; k < cells; ++k) {
      const double odd = nodal[std::size_t(2 * k + 1)];
      own[k] = odd;
      coarser[std::size_t(k)] += 0.5 * odd;
      coarser[std::size_t(k + 1)] = nodal[std::size_t(2 * k + 2)] + 0.5 * odd;
    }
    std::swap(nodal, coarser);
  }
  surpluses[0] = nodal[0];
  surpluses[1] = nodal[1];
}

} // namespace

struct hbSampleOperator::Workspace {
  std::vector<double> line, nodal, other;

  explicit Workspace(std::int64_t length)
      : line(std::size_t(length)), nodal(std::size_t(length)), other(std::size_t(length)) {}
};

template <class Visit>
void hbSampleOperator::forSlots(bool flat, int level, Visit visit) {
  visit(std::size_t(level == 0 ? 0 : level + 1));
  if (level == 0 && !flat) visit(std::size_t{1});
}

std::vector<hbSampleOperator::Rows> hbSampleOperator::rowsOf(const hbIndexSet& set) {
  std::vector<Rows> rows;
  std::int64_t offset = 0;
  for (int ly = 0; ly <= set.finest().y; ++ly) {
    int lx = 0;
    while (set.contains({lx + 1, ly, 0})) ++lx;
    const std::int64_t length = set.flat().x ? 1 : (std::int64_t{1} << lx) + 1;
    rows.push_back({offset, hbIndexSet::axisNodes(set.flat().y, ly), length});
    offset += rows.back().count * length;
  }
  return rows;
}

hbSampleOperator::hbSampleOperator(const hbIndexSet& set, const std::array<std::span<const double>, 3>& coordinates)
    : set_(set), rows_(rowsOf(set)) {
  for (int d = 0; d < 3; ++d) assert(!set.flat()[d] || coordinates[std::size_t(d)].size() == 1);
  planeSize_ = rows_.back().offset + rows_.back().count * rows_.back().length;
  for (int d = 1; d < 3; ++d)
    for (const double u : coordinates[std::size_t(d)])
      hats_[std::size_t(d - 1)].emplace_back().evaluate(u, set.flat()[d], set.finest()[d]);
  const std::int64_t cells = std::int64_t{1} << set.finest().x;
  for (const double u : coordinates[0]) {
    const double place = set.flat().x ? 0.0 : u * double(cells);
    cell_.push_back(std::min(std::int64_t(place), cells - 1));
    step_.push_back(place - double(cell_.back()));
  }
}

double hbSampleOperator::bytes(const hbIndexSet& set, const hbSize3& samples) {
  const Rows last = rowsOf(set).back();
  return 8.0 * double(last.offset + last.count * last.length) * double(samples.z) +
         double(samples.y + samples.z) * double(sizeof(hbHat<double>)) +
         8.0 * planesAtOnce(samples) * double(samples.x) * double(samples.y);
}

double hbSampleOperator::planesAtOnce(const hbSize3& samples) {
  return double(std::min<std::int64_t>(samples.z, hb::parallelThreads()));
}

void hbSampleOperator::planeSums(std::span<const double> surpluses, std::int64_t z, std::span<double> sums) const {
  std::fill(sums.begin(), sums.end(), 0.0);
  const hbHat<double>& hat = hats_[1][std::size_t(z)];
  for (const hbSubspace& s : set_.subspaces())
    forSlots(set_.flat().z, s.levels.z, [&](std::size_t slot) {
      const double weight = hat.weight[slot];
      if (weight == 0.0) return;
      const Rows& rows = rows_[std::size_t(s.levels.y)];
      const double* from = surpluses.data() + s.offset + hat.node[slot] * s.nodes.x * s.nodes.y;
      double* to = sums.data() + rows.offset + lineOffset(s.levels.x);
      for (std::int64_t j = 0; j < s.nodes.y; ++j, from += s.nodes.x, to += rows.length)
        for (std::int64_t i = 0; i < s.nodes.x; ++i) to[i] += weight * from[i];
    });
}

void hbSampleOperator::planeValues(std::span<const double> sums, Workspace& workspace, std::span<double> values) const {
  std::vector<double>& line = workspace.line;
  double* out = values.data();
  for (const hbHat<double>& hat : hats_[0]) {
    std::fill(line.begin(), line.end(), 0.0);
    for (int level = 0; level <= set_.finest().y; ++level)
      forSlots(set_.flat().y, level, [&](std::size_t slot) {
        const double weight = hat.weight[slot];
        if (weight == 0.0) return;
        const Rows& rows = rows_[std::size_t(level)];
        const double* from = sums.data() + rows.offset + hat.node[slot] * rows.length;
        for (std::int64_t i = 0; i < rows.length; ++i) line[std::size_t(i)] += weight * from[i];
      });
    if (set_.flat().x) {
      *out++ = line[0];
      continue;
    }
    dehierarchiseLine(line.data(), set_.finest().x, workspace.nodal, workspace.other);
    for (std::size_t i = 0; i < cell_.size(); ++i) {
      const double* cell = workspace.nodal.data() + cell_[i];
      out[i] = cell[0] + step_[i] * (cell[1] - cell[0]);
    }
    out += cell_.size();
  }
}

void hbSampleOperator::planeTransposed(std::span<const double> values, Workspace& workspace,
                                       std::span<double> sums) const {
  std::fill(sums.begin(), sums.end(), 0.0);
  std::vector<double>& line = workspace.line;
  const double* from = values.data();
  for (const hbHat<double>& hat : hats_[0]) {
    if (set_.flat().x) {
      line[0] = *from++;
    } else {
      std::fill(workspace.nodal.begin(), workspace.nodal.end(), 0.0);
      for (std::size_t i = 0; i < cell_.size(); ++i) {
        double* cell = workspace.nodal.data() + cell_[i];
        const double upper = step_[i] * from[i];
        cell[0] += from[i] - upper;
        cell[1] += upper;
      }
      from += cell_.size();
      transposedLine(workspace.nodal, workspace.other, set_.finest().x, line.data());
    }
    for (int level = 0; level <= set_.finest().y; ++level)
      forSlots(set_.flat().y, level, [&](std::size_t slot) {
        const double weight = hat.weight[slot];
        if (weight == 0.0) return;
        const Rows& rows = rows_[std::size_t(level)];
        double* to = sums.data() + rows.offset + hat.node[slot] * rows.length;
        for (std::int64_t i = 0; i < rows.length; ++i) to[i] += weight * line[std::size_t(i)];
      });
  }
}

void hbSampleOperator::gather(std::span<const double> sums, const hbSubspace& s, std::span<double> out) const {
  double* const own = out.data() + s.offset;
  std::fill_n(own, s.count(), 0.0);
  const Rows& rows = rows_[std::size_t(s.levels.y)];
  for (std::size_t z = 0; z < hats_[1].size(); ++z)
    forSlots(set_.flat().z, s.levels.z, [&](std::size_t slot) {
      const double weight = hats_[1][z].weight[slot];
      if (weight == 0.0) return;
      const double* from = sums.data() + std::int64_t(z) * planeSize_ + rows.offset + lineOffset(s.levels.x);
      double* to = own + hats_[1][z].node[slot] * s.nodes.x * s.nodes.y;
      for (std::int64_t j = 0; j < s.nodes.y; ++j, from += rows.length, to += s.nodes.x)
        for (std::int64_t i = 0; i < s.nodes.x; ++i) to[i] += weight * from[i];
    });
}

void hbSampleOperator::apply(std::span<const double> surpluses, const PlaneWork& work,
                             const hbProgress& progress) const {
  assert(std::int64_t(surpluses.size()) == set_.storedValues());
  hb::parallelFor(std::int64_t(hats_[1].size()), [&](std::int64_t z) {
    if (progress.cancelled()) return;
    Workspace workspace(rows_.front().length);
    std::vector<double> sums(static_cast<std::size_t>(planeSize_)), values(cell_.size() * hats_[0].size());
    planeSums(surpluses, z, sums);
    planeValues(sums, workspace, values);
    work(z, values);
  });
}

void hbSampleOperator::applyTransposed(const PlaneWork& fill, std::span<double> out, const hbProgress& progress) const {
  applyBoth({}, fill, out, progress);
}

void hbSampleOperator::applyBoth(std::span<const double> surpluses, const PlaneWork& work, std::span<double> out,
                                 const hbProgress& progress) const {
  assert(std::int64_t(out.size()) == set_.storedValues());
  const auto planes = std::int64_t(hats_[1].size());
  std::vector<double> sums(std::size_t(planes * planeSize_));
  hb::parallelFor(planes, [&](std::int64_t z) {
    if (progress.cancelled()) return;
    Workspace workspace(rows_.front().length);
    std::vector<double> values(cell_.size() * hats_[0].size());
    const std::span own = std::span(sums).subspan(std::size_t(z * planeSize_), std::size_t(planeSize_));
    if (!surpluses.empty()) {
      planeSums(surpluses, z, own);
      planeValues(own, workspace, values);
    }
    work(z, values);
    planeTransposed(values, workspace, own);
  });
  if (progress.cancelled()) return;
  const std::vector<hbSubspace>& subspaces = set_.subspaces();
  hb::parallelFor(std::int64_t(subspaces.size()),
                  [&](std::int64_t s) { gather(sums, subspaces[std::size_t(s)], out); });
}

double hbSampleOperator::rootMeanSquare(std::span<const double> surpluses) const {
  std::vector<double> squares(hats_[1].size());
  apply(surpluses, [&](std::int64_t z, std::span<double> values) {
    squares[std::size_t(z)] = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  });
  const double count = double(cell_.size()) * double(hats_[0].size()) * double(hats_[1].size());
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) / count);
}
