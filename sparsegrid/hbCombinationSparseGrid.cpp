#include "sparsegrid/hbCombinationSparseGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sparsegrid/hbComponentNodes.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "sparsegrid/kernels/hbCombinationKernel.h"
#include "volume/hbError.h"

namespace {

/// The cell of a component grid's axis: its lower node, the step to the upper one (0 on a flat axis) and the place
/// inside.
struct Cell {
  std::int64_t index;
  std::int64_t step;
  float t;
};

// Sizes are 2^l + 1, so u * 2^l is exact and the cells nest: every grid sees a node of the sparse grid as its own node.
Cell cellOf(float u, std::int64_t nodes) {
  if (nodes == 1) return {0, 0, 0.0F};
  const float position = u * float(nodes - 1);
  const std::int64_t index = std::min(std::int64_t(position), nodes - 2);
  return {index, 1, position - float(index)};
}

float lerp(float a, float b, float t) { return a + t * (b - a); }

float clamped(float u) { return u > 0.0F ? std::min(u, 1.0F) : 0.0F; }

std::vector<double> coefficientsOf(const hbIndexSet& set) {
  std::vector<double> coefficients;
  for (const hbIndexSet::ComponentGrid& component : set.componentGrids()) coefficients.push_back(component.coefficient);
  return coefficients;
}

void checkCoefficients(std::span<const double> coefficients, std::size_t grids) {
  if (coefficients.size() != grids)
    throw hbError(fmt::format("combination: expected {} coefficients, found {}", grids, coefficients.size()));
  for (const double c : coefficients)
    if (!std::isfinite(c)) throw hbError(fmt::format("combination: expected finite coefficients, found {}", c));
}

hbCombinationTerms termsOf(const hbSparseGrid& grid, const std::vector<hbCombinationSparseGrid::Grid>& grids) {
  hbCombinationTerms terms;
  for (int d = 0; d < 3; ++d)
    terms.axes[std::size_t(d)] = {grid.indexSet().flat()[d], grid.indexSet().finest()[d], grid.latticeScale()[d]};
  for (const auto& g : grids)
    terms.grids.push_back({g.levels, g.coefficient, g.nodes.y == 1 ? 0 : g.nodes.x,
                           g.nodes.z == 1 ? 0 : g.nodes.x * g.nodes.y, g.offset});
  return terms;
}

} // namespace

double hbCombinationSparseGrid::bytes(const hbIndexSet& set, int components) {
  return double(sizeof(float)) * double(set.combinationValues()) * components +
         double(sizeof(double)) * double(set.storedValues());
}

hbCombinationSparseGrid::hbCombinationSparseGrid(const hbSparseGrid& grid)
    : hbCombinationSparseGrid(grid, coefficientsOf(grid.indexSet())) {}

hbCombinationSparseGrid::hbCombinationSparseGrid(const hbSparseGrid& grid, std::span<const double> coefficients)
    : frame_(grid.frame()) {
  const hbIndexSet& set = grid.indexSet();
  const std::vector<hbIndexSet::ComponentGrid> components = set.componentGrids();
  checkCoefficients(coefficients, components.size());
  std::int64_t count = 0;
  for (std::size_t i = 0; i < components.size(); ++i) {
    grids_.push_back({components[i].levels, coefficients[i], components[i].nodes, count});
    if (grids_.back().count() > std::numeric_limits<std::int32_t>::max())
      throw hbError(fmt::format("component grid: expected fewer than 2^31 nodes, found {}", grids_.back().count()));
    count += grids_.back().count();
  }
  for (int c = 0; c < grid.components(); ++c) {
    const std::vector<double> nodal = grid.nodalValues(c);
    // One value more than there are: on a flat x axis the kernel reads past the last one.
    std::vector<float>& values = values_.emplace_back(std::size_t(count + 1), 0.0F);
    for (const Grid& to : grids_) hb::copyComponentNodes(set, nodal, to.levels, values.data() + to.offset);
  }
  terms_ = std::make_shared<const hbCombinationTerms>(termsOf(grid, grids_));
}

void hbCombinationSparseGrid::values(const hbPoints& points, int component, std::span<float> out) const {
  hb::evaluateCombination(*terms_, values_[std::size_t(component)].data(), points, out, nullptr);
}

void hbCombinationSparseGrid::gradients(const hbPoints& points, int component, std::span<float> out,
                                        const hbGradients& gradient) const {
  hb::evaluateCombination(*terms_, values_[std::size_t(component)].data(), points, out, &gradient);
}

void hbCombinationSparseGrid::values(const hbPoints64& points, int component, std::span<double> out) const {
  hb::evaluateCombination(*terms_, values_[std::size_t(component)].data(), points, out, nullptr);
}

void hbCombinationSparseGrid::gradients(const hbPoints64& points, int component, std::span<double> out,
                                        const hbGradients64& gradient) const {
  hb::evaluateCombination(*terms_, values_[std::size_t(component)].data(), points, out, &gradient);
}

glm::dvec3 hbCombinationSparseGrid::latticeScale() const {
  return {terms_->axes[0].scale, terms_->axes[1].scale, terms_->axes[2].scale};
}

float hbCombinationSparseGrid::calcValue32(const glm::vec3& point, int component) const {
  // Scales are exact in floats, so each product is rounded once, as it is everywhere else.
  const auto u = [&](int d) { return clamped(point[d]) * float(terms_->axes[std::size_t(d)].scale); };
  double sum = 0.0;
  for (const Grid& grid : grids_) {
    const Cell x = cellOf(u(0), grid.nodes.x), y = cellOf(u(1), grid.nodes.y), z = cellOf(u(2), grid.nodes.z);
    const float* v = values(grid, component).data() + x.index + grid.nodes.x * (y.index + grid.nodes.y * z.index);
    const std::int64_t dy = grid.nodes.x * y.step, dz = grid.nodes.x * grid.nodes.y * z.step;
    const auto along = [&](std::int64_t corner) { return lerp(v[corner], v[corner + dy], y.t); };
    const float lower = lerp(along(0), along(dz), z.t), upper = lerp(along(x.step), along(x.step + dz), z.t);
    sum += double(float(grid.coefficient) * lerp(lower, upper, x.t));
  }
  return float(sum);
}

hbRange hbCombinationSparseGrid::range(const hbBox& box, int component) const {
  double lo = 0.0, hi = 0.0, magnitude = 0.0;
  for (const Grid& grid : grids_) {
    hbSize3 first, last;
    for (int d = 0; d < 3; ++d) {
      first[d] = cellOf(float(clamped(box.lo[d]) * terms_->axes[std::size_t(d)].scale), grid.nodes[d]).index;
      const Cell cell = cellOf(float(clamped(box.hi[d]) * terms_->axes[std::size_t(d)].scale), grid.nodes[d]);
      last[d] = cell.index + cell.step;
    }
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (std::int64_t k = first.z; k <= last.z; ++k)
      for (std::int64_t j = first.y; j <= last.y; ++j)
        for (std::int64_t i = first.x; i <= last.x; ++i) {
          const double v = values(grid, component)[std::size_t(i + grid.nodes.x * (j + grid.nodes.y * k))];
          least = std::min(least, v);
          greatest = std::max(greatest, v);
        }
    lo += grid.coefficient * (grid.coefficient > 0.0 ? least : greatest);
    hi += grid.coefficient * (grid.coefficient > 0.0 ? greatest : least);
    magnitude += std::abs(grid.coefficient) * std::max(std::abs(least), std::abs(greatest));
  }
  // The bound of doc/sparse-grids.md.
  const double slack = hb::kCombinationRoundings * 0x1p-24 * magnitude;
  return {float(lo - slack), float(hi + slack)};
}
