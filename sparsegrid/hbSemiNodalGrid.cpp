#include "sparsegrid/hbSemiNodalGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sparsegrid/kernels/hbSemiNodalKernel.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

/// The lines of one pair of levels; level 1 (of a coarse or flat axis 0) stands for the base grid.
struct Block {
  int levelY = 0, levelZ = 0;
  int levelX = 0; ///< The lines' 2^levelX cells.
  std::int64_t nodesY = 1, nodesZ = 1;
  std::int64_t offset = 0;

  std::int64_t length() const { return (std::int64_t{1} << levelX) + 1; }
  std::int64_t values() const { return nodesY * nodesZ * length(); }
};

/// The level and the nodes of the base grid of one axis.
struct Base {
  int level;
  std::int64_t nodes;
  Base(const hbIndexSet& set, int axis)
      : level(set.finest()[axis] > 0 ? 1 : 0), nodes(set.flat()[axis]         ? 1
                                                     : set.finest()[axis] > 0 ? 3
                                                                              : 2) {}
};

std::vector<Block> blocksOf(const hbIndexSet& set) {
  const Base baseY(set, 1), baseZ(set, 2);
  std::vector<Block> blocks;
  for (int z = baseZ.level; z <= set.finest().z; ++z)
    for (int y = baseY.level; y <= set.finest().y && set.contains({0, y, z}); ++y) {
      Block block{y, z};
      while (set.contains({block.levelX + 1, y, z})) ++block.levelX;
      block.nodesY = y == baseY.level ? baseY.nodes : hbIndexSet::axisNodes(false, y);
      block.nodesZ = z == baseZ.level ? baseZ.nodes : hbIndexSet::axisNodes(false, z);
      blocks.push_back(block);
    }
  // Blocks with short lines have the finest levels of y and z, so the smallest values, which are to be summed first.
  std::stable_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) { return a.levelX < b.levelX; });
  std::int64_t offset = 0;
  for (Block& block : blocks) {
    block.offset = offset;
    offset += block.values();
  }
  return blocks;
}

/// A node of an axis as the sum of nodes of the hierarchical basis: of the base grid's three nodes, the middle one's
/// nodal value takes part of both ends' in.
struct Part {
  int level;
  std::int64_t index;
  double weight;
};
std::vector<Part> partsOf(const Base& base, int level, std::int64_t node) {
  if (level != base.level) return {{level, node, 1.0}};
  if (base.nodes < 3) return {{0, node, 1.0}};
  if (node == 1) return {{0, 0, 0.5}, {0, 1, 0.5}, {1, 0, 1.0}};
  return {{0, node / 2, 1.0}};
}

/// Builds the lines of one component.
class Lines {
public:
  Lines(const hbSparseGrid& grid, int component)
      : grid_(grid), set_(grid.indexSet()), component_(component), baseY_(set_, 1), baseZ_(set_, 2) {}

  void build(const Block& block, float* out) const {
    const auto length = std::size_t(block.length());
    std::vector<double> line(length);
    for (std::int64_t iz = 0; iz < block.nodesZ; ++iz)
      for (std::int64_t iy = 0; iy < block.nodesY; ++iy) {
        std::fill(line.begin(), line.end(), 0.0);
        for (const Part& z : partsOf(baseZ_, block.levelZ, iz))
          for (const Part& y : partsOf(baseY_, block.levelY, iy)) addSurpluses(block, y, z, line);
        dehierarchise(block.levelX, line);
        for (std::size_t i = 0; i < length; ++i) out[std::size_t(iz * block.nodesY + iy) * length + i] = float(line[i]);
      }
  }

private:
  /// Adds the surpluses of one line, each at its node's place.
  void addSurpluses(const Block& block, const Part& y, const Part& z, std::vector<double>& line) const {
    const double weight = y.weight * z.weight;
    for (int level = 0; level <= block.levelX; ++level) {
      const hbSubspace& subspace = set_.subspace({level, y.level, z.level});
      const float* from =
          grid_.surpluses(subspace, component_).data() + subspace.nodes.x * (y.index + subspace.nodes.y * z.index);
      const std::size_t step = std::size_t{1} << (block.levelX - level);
      if (level == 0) {
        line.front() += weight * double(from[0]);
        line.back() += weight * double(from[subspace.nodes.x - 1]); // a flat axis has its only node at both ends
      } else {
        for (std::int64_t k = 0; k < subspace.nodes.x; ++k)
          line[std::size_t(2 * k + 1) * step] += weight * double(from[k]);
      }
    }
  }

  static void dehierarchise(int finest, std::vector<double>& line) {
    for (int level = 1; level <= finest; ++level) {
      const std::size_t step = std::size_t{1} << (finest - level);
      for (std::size_t i = step; i < line.size(); i += 2 * step) line[i] += 0.5 * (line[i - step] + line[i + step]);
    }
  }

  const hbSparseGrid& grid_;
  const hbIndexSet& set_;
  int component_;
  Base baseY_, baseZ_;
};

/// The nodes of an axis that have a part in the values between two lattice coordinates: first to last.
struct Span {
  std::int64_t first, last;
};
Span nodesBetween(double lo, double hi, std::int64_t cells) {
  const auto cell = [&](double u) { return std::min(std::int64_t(u * double(cells)), cells - 1); };
  return {cell(lo), cell(hi) + 1};
}
Span hatsBetween(double lo, double hi, std::int64_t nodes) {
  const auto [first, end] = nodesBetween(lo, hi, nodes);
  return {first, end - 1};
}

} // namespace

struct hbSemiNodalGrid::Layout {
  std::vector<Block> blocks;
  hbSemiNodalTerms terms;

  explicit Layout(const hbSparseGrid& grid) : blocks(blocksOf(grid.indexSet())) {
    const hbIndexSet& set = grid.indexSet();
    for (int d = 0; d < 3; ++d)
      terms.axes[std::size_t(d)] = {std::int32_t(Base(set, d).nodes - 1), set.finest()[d], grid.latticeScale()[d]};
    const auto slots = [&](int level, int axis) {
      const Base base(set, axis);
      if (level != base.level) return std::vector{level};
      return base.nodes == 1 ? std::vector{0} : std::vector{0, 1};
    };
    for (const Block& block : blocks) {
      if (terms.groups.empty() || terms.groups.back().level != block.levelX)
        terms.groups.push_back({block.levelX, terms.terms.size(), terms.terms.size()});
      for (const int z : slots(block.levelZ, 2))
        for (const int y : slots(block.levelY, 1))
          terms.terms.push_back({y, z, std::int32_t(block.nodesY), block.offset});
      terms.groups.back().end = terms.terms.size();
    }
  }
};

bool hbSemiNodalGrid::fits(const hbIndexSet& set) {
  const std::vector<Block> blocks = blocksOf(set);
  return std::all_of(blocks.begin(), blocks.end(),
                     [](const Block& b) { return b.values() <= std::numeric_limits<std::int32_t>::max(); });
}

double hbSemiNodalGrid::bytes(const hbIndexSet& set, int components) {
  const Block last = blocksOf(set).back();
  return double(sizeof(float)) * double(last.offset + last.values()) * components;
}

hbSemiNodalGrid::hbSemiNodalGrid(const hbSparseGrid& grid)
    : frame_(grid.frame()), layout_(std::make_shared<const Layout>(grid)) {
  const std::vector<Block>& blocks = layout_->blocks;
  if (!fits(grid.indexSet()))
    throw hbError("sparse grid: expected fewer than 2^31 values for each pair of levels of y and z; the engine direct "
                  "takes more");
  for (int c = 0; c < grid.components(); ++c) {
    std::vector<float>& values = values_.emplace_back(std::size_t(blocks.back().offset + blocks.back().values()));
    const Lines lines(grid, c);
    hb::parallelFor(std::int64_t(blocks.size()), [&](std::int64_t b) {
      const Block& block = blocks[std::size_t(b)];
      lines.build(block, values.data() + block.offset);
    });
  }
}

const hbSemiNodalTerms& hbSemiNodalGrid::terms() const { return layout_->terms; }

void hbSemiNodalGrid::values(const hbPoints& points, int component, std::span<float> out) const {
  hb::evaluateSemiNodal(layout_->terms, values_[std::size_t(component)].data(), points, out, nullptr);
}

void hbSemiNodalGrid::gradients(const hbPoints& points, int component, std::span<float> out,
                                const hbGradients& gradient) const {
  hb::evaluateSemiNodal(layout_->terms, values_[std::size_t(component)].data(), points, out, &gradient);
}

void hbSemiNodalGrid::values(const hbPoints64& points, int component, std::span<double> out) const {
  hb::evaluateSemiNodal(layout_->terms, values_[std::size_t(component)].data(), points, out, nullptr);
}

void hbSemiNodalGrid::gradients(const hbPoints64& points, int component, std::span<double> out,
                                const hbGradients64& gradient) const {
  hb::evaluateSemiNodal(layout_->terms, values_[std::size_t(component)].data(), points, out, &gradient);
}

void hbSemiNodalGrid::lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs,
                              int component, float* out, std::size_t strideY, std::size_t strideZ) const {
  std::vector<double> y(xs.size()), z(xs.size()), row(xs.size());
  for (std::size_t k = 0; k < zs.size(); ++k) {
    std::fill(z.begin(), z.end(), zs[k]);
    for (std::size_t j = 0; j < ys.size(); ++j) {
      std::fill(y.begin(), y.end(), ys[j]);
      values(hbPoints64{xs, y, z}, component, row);
      std::copy(row.begin(), row.end(), out + j * strideY + k * strideZ);
    }
  }
}

hbRange hbSemiNodalGrid::range(const hbBox& box, int component) const {
  const auto& axes = layout_->terms.axes;
  glm::dvec3 from, to;
  for (int d = 0; d < 3; ++d) {
    const double scale = axes[std::size_t(d)].scale;
    from[d] = (box.lo[d] > 0.0F ? std::min(double(box.lo[d]), 1.0) : 0.0) * scale;
    to[d] = (box.hi[d] > 0.0F ? std::min(double(box.hi[d]), 1.0) : 0.0) * scale;
  }
  // The nodes of one axis of a block, and whether their weights at a point sum to 1: those of the base grid do.
  const auto nodes = [&](int d, int level, std::int64_t count) -> std::pair<Span, bool> {
    const hbSemiNodalTerms::Axis& axis = axes[std::size_t(d)];
    if (axis.baseCells == 0) return {{0, 0}, true};
    if (level < 2) return {nodesBetween(from[d], to[d], axis.baseCells), true};
    return {hatsBetween(from[d], to[d], count), false};
  };
  double lo = 0.0, hi = 0.0, magnitude = 0.0;
  for (const Block& block : layout_->blocks) {
    const Span x = nodesBetween(from.x, to.x, block.length() - 1);
    const auto [y, convexY] = nodes(1, block.levelY, block.nodesY);
    const auto [z, convexZ] = nodes(2, block.levelZ, block.nodesZ);
    double least = convexY && convexZ ? std::numeric_limits<double>::infinity() : 0.0, greatest = -least;
    for (std::int64_t k = z.first; k <= z.last; ++k)
      for (std::int64_t j = y.first; j <= y.last; ++j) {
        const float* line =
            values_[std::size_t(component)].data() + block.offset + (k * block.nodesY + j) * block.length();
        const auto [smallest, largest] = std::minmax_element(line + x.first, line + x.last + 1);
        least = std::min(least, double(*smallest));
        greatest = std::max(greatest, double(*largest));
      }
    lo += least;
    hi += greatest;
    magnitude += std::max(std::abs(least), std::abs(greatest));
  }
  // The bound of doc/sparse-grids.md, 8 + terms of one length + lengths, where a block has four terms at most; the ends
  // are rounded to floats, too.
  const double slack = (9.0 + 5.0 * double(layout_->blocks.size())) * 0x1p-24 * magnitude;
  return {float(lo - slack), float(hi + slack)};
}
