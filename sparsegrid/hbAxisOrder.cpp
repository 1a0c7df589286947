#include "sparsegrid/hbAxisOrder.h"

#include <cmath>

#include "sparsegrid/kernels/hbLatticeKernel.h"

namespace {

/// What a lattice costs, in nanoseconds on the processor of doc/results.md; only the ratios matter.
constexpr double kSurplus = 0.1;      ///< added up for a plane,
constexpr double kNode = 0.3;         ///< dehierarchised of a coarse line,
constexpr double kCoarseSample = 0.5; ///< of a coarse row,
constexpr double kRow = 40.0;         ///< a table,
constexpr double kSample = 0.15;      ///< a sample from it,
constexpr double kScattered = 2.0;    ///< and to a place of its own; and
constexpr double kReordered = 3.0;    ///< a surplus copied.

} // namespace

hbAxisOrder hbAxisOrder::cheapest(const hbIndexSet& set, const hbSize3& samples) {
  const hbAxisOrder natural;
  const auto cost = [&](const hbAxisOrder& order) {
    const auto size = [&](int axis) { return double(samples[axis]); };
    double sums = 0.0, coarse = 0.0, fine = size(order.row) * kRow;
    for (int row = 0; set.contains(order.inCube(0, row, 0)); ++row) {
      int fast = 0;
      double rows = 0.0;
      for (; set.contains(order.inCube(fast, row, 0)); ++fast) {
        int plane = 0;
        while (set.contains(order.inCube(fast, row, plane))) ++plane;
        const hbSize3 nodes = set.subspace(order.inCube(fast, row, 0)).nodes;
        rows = double(nodes[order.row]);
        sums += double(nodes[order.fast]) * rows * double(plane) * kSurplus;
      }
      if (fast - 1 > hbLatticeTableParts::kTableLevel || row == 0)
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
