#include "sparsegrid/hbCombinationSparseGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

struct Corners {
  std::array<float, 8> v; ///< x fastest
  Corners(const std::vector<float>& values, const hbSize3& nodes, const Cell& x, const Cell& y, const Cell& z) {
    const float* at = values.data() + x.index + nodes.x * (y.index + nodes.y * z.index);
    const std::int64_t dy = nodes.x * y.step, dz = nodes.x * nodes.y * z.step;
    v = {at[0], at[x.step], at[dy], at[dy + x.step], at[dz], at[dz + x.step], at[dz + dy], at[dz + dy + x.step]};
  }
};

float clamped(float u) { return u > 0.0F ? std::min(u, 1.0F) : 0.0F; }

} // namespace

hbCombinationSparseGrid::hbCombinationSparseGrid(const hbSparseGrid& grid)
    : frame_(grid.frame()), scale_(grid.latticeScale()) {
  const hbIndexSet& set = grid.indexSet();
  for (const hbIndexSet::ComponentGrid& component : set.componentGrids())
    grids_.push_back({component.levels, component.coefficient, component.nodes, {}});
  for (int c = 0; c < grid.components(); ++c) {
    const std::vector<double> nodal = grid.nodalValues(c);
    for (Grid& to : grids_) {
      std::vector<float>& values = to.values.emplace_back();
      values.reserve(std::size_t(to.nodes.x * to.nodes.y * to.nodes.z));
      for (std::int64_t k = 0; k < to.nodes.z; ++k) {
        const auto [lz, iz] = hbIndexSet::axisNode(set.flat().z, to.levels.z, k);
        for (std::int64_t j = 0; j < to.nodes.y; ++j) {
          const auto [ly, iy] = hbIndexSet::axisNode(set.flat().y, to.levels.y, j);
          for (std::int64_t i = 0; i < to.nodes.x; ++i) {
            const auto [lx, ix] = hbIndexSet::axisNode(set.flat().x, to.levels.x, i);
            const hbSubspace& from = set.subspace({lx, ly, lz});
            values.push_back(float(nodal[std::size_t(from.offset + ix + from.nodes.x * (iy + from.nodes.y * iz))]));
          }
        }
      }
    }
  }
}

// Rounded once from the 64-bit product, as hbSparseGrid does it: both engines see the same point.
glm::vec3 hbCombinationSparseGrid::latticePoint(const hbPoints& points, std::size_t i) const {
  return glm::vec3(glm::dvec3(clamped(points.x[i]), clamped(points.y[i]), clamped(points.z[i])) * scale_);
}

void hbCombinationSparseGrid::values(const hbPoints& points, int component, std::span<float> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 u = latticePoint(points, i);
    double sum = 0.0;
    for (const Grid& grid : grids_) {
      const Cell x = cellOf(u.x, grid.nodes.x), y = cellOf(u.y, grid.nodes.y), z = cellOf(u.z, grid.nodes.z);
      const auto v = Corners(grid.values[std::size_t(component)], grid.nodes, x, y, z).v;
      const float value = lerp(lerp(lerp(v[0], v[1], x.t), lerp(v[2], v[3], x.t), y.t),
                               lerp(lerp(v[4], v[5], x.t), lerp(v[6], v[7], x.t), y.t), z.t);
      sum += double(grid.coefficient) * double(value);
    }
    out[i] = float(sum);
  }
}

void hbCombinationSparseGrid::gradients(const hbPoints& points, int component, std::span<float> out,
                                        const hbGradients& gradient) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 u = latticePoint(points, i);
    double sum = 0.0;
    glm::dvec3 slopes(0.0);
    for (const Grid& grid : grids_) {
      const Cell x = cellOf(u.x, grid.nodes.x), y = cellOf(u.y, grid.nodes.y), z = cellOf(u.z, grid.nodes.z);
      const auto v = Corners(grid.values[std::size_t(component)], grid.nodes, x, y, z).v;
      const float x00 = lerp(v[0], v[1], x.t), x10 = lerp(v[2], v[3], x.t), x01 = lerp(v[4], v[5], x.t),
                  x11 = lerp(v[6], v[7], x.t);
      const float xy0 = lerp(x00, x10, y.t), xy1 = lerp(x01, x11, y.t);
      const glm::vec3 inCell(lerp(lerp(v[1] - v[0], v[3] - v[2], y.t), lerp(v[5] - v[4], v[7] - v[6], y.t), z.t),
                             lerp(x10 - x00, x11 - x01, z.t), xy1 - xy0);
      sum += double(grid.coefficient) * double(lerp(xy0, xy1, z.t));
      slopes += double(grid.coefficient) * glm::dvec3(inCell) * glm::dvec3(grid.nodes - std::int64_t(1));
    }
    out[i] = float(sum);
    gradient.dx[i] = float(slopes.x * scale_.x);
    gradient.dy[i] = float(slopes.y * scale_.y);
    gradient.dz[i] = float(slopes.z * scale_.z);
  }
}

hbRange hbCombinationSparseGrid::range(const hbBox& box, int component) const {
  double lo = 0.0, hi = 0.0, magnitude = 0.0;
  for (const Grid& grid : grids_) {
    hbSize3 first, last;
    for (int d = 0; d < 3; ++d) {
      first[d] = cellOf(float(clamped(box.lo[d]) * scale_[d]), grid.nodes[d]).index;
      const Cell cell = cellOf(float(clamped(box.hi[d]) * scale_[d]), grid.nodes[d]);
      last[d] = cell.index + cell.step;
    }
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (std::int64_t k = first.z; k <= last.z; ++k)
      for (std::int64_t j = first.y; j <= last.y; ++j)
        for (std::int64_t i = first.x; i <= last.x; ++i) {
          const double v = grid.values[std::size_t(component)][std::size_t(i + grid.nodes.x * (j + grid.nodes.y * k))];
          least = std::min(least, v);
          greatest = std::max(greatest, v);
        }
    lo += grid.coefficient * (grid.coefficient > 0 ? least : greatest);
    hi += grid.coefficient * (grid.coefficient > 0 ? greatest : least);
    magnitude += std::abs(grid.coefficient) * std::max(std::abs(least), std::abs(greatest));
  }
  // Each trilinear value rounds up to nine times in 32 bits, the sum once more.
  const double slack = 10.0 * 0x1p-24 * magnitude;
  return {float(lo - slack), float(hi + slack)};
}
