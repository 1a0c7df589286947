#include "sparsegrid/kernels/hbHierarchiseKernel.h"

#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbHierarchiseKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// In all of this, `own` are the nodes (2k+1) 2^-l of one level; the grid of level l-1 has the nodes k 2^-(l-1) on both
// sides of them.

template <LineTransform transform, class V>
HWY_INLINE V transformed(V own, V left, V right, V half) {
  const V mean = hn::Mul(half, hn::Add(left, right));
  return transform == LineTransform::hierarchise ? hn::Sub(own, mean) : hn::Add(own, mean);
}
template <LineTransform transform>
HWY_INLINE double transformed(double own, double left, double right) {
  const double mean = 0.5 * (left + right);
  return transform == LineTransform::hierarchise ? own - mean : own + mean;
}

/// `count` lines beside each other, one node of each: own is replaced.
template <LineTransform transform>
HWY_INLINE void transformRow(double* own, const double* left, const double* right, std::int64_t count) {
  const hn::ScalableTag<double> d;
  const auto half = hn::Set(d, 0.5);
  const auto lanes = std::int64_t(hn::Lanes(d));
  std::int64_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(transformed<transform>(hn::LoadU(d, own + i), hn::LoadU(d, left + i), hn::LoadU(d, right + i), half), d,
               own + i);
  for (; i < count; ++i) own[i] = transformed<transform>(own[i], left[i], right[i]);
}

/// Wide rows: node by node, with both neighbours' rows where they lie.
template <LineTransform transform>
HWY_INLINE void wideRows(const LinePart& part, std::int64_t outer, double* values) {
  const hbLineGroup& group = *part.group;
  const std::int64_t inner = group.inner, count = part.lastInner - part.firstInner;
  const auto row = [&](int level, std::int64_t k) {
    const hbIndexSet::AxisNode node = hbIndexSet::axisNode(false, level, k);
    const std::int64_t nodes = hbIndexSet::axisNodes(false, node.level);
    return values + group.offset[std::size_t(node.level)] + (outer * nodes + node.index) * inner + part.firstInner;
  };
  const auto level = [&](int l) HWY_ATTR {
    const std::int64_t nodes = hbIndexSet::axisNodes(false, l);
    double* own = values + group.offset[std::size_t(l)] + outer * nodes * inner + part.firstInner;
    const double* left = row(l - 1, 0);
    for (std::int64_t k = 0; k < nodes; ++k, own += inner) {
      const double* right = row(l - 1, k + 1);
      transformRow<transform>(own, left, right, count);
      left = right;
    }
  };
  // A node's neighbours have to be nodal: finer levels go first, or last.
  if (transform == LineTransform::hierarchise)
    for (int l = group.finest; l >= 1; --l) level(l);
  else
    for (int l = 1; l <= group.finest; ++l) level(l);
}

/// Short lines, of a few nodes, all at once in registers.
template <LineTransform transform, int finest, int inner>
HWY_INLINE void shortLines(const hbLineGroup& group, std::int64_t first, std::int64_t last, double* values) {
  constexpr int cells = 1 << finest;
  for (std::int64_t outer = first; outer < last; ++outer)
    for (int i = 0; i < inner; ++i) {
      double nodal[cells + 1];
      const double* ends = values + group.offset[0] + outer * 2 * inner + i;
      nodal[0] = ends[0];
      nodal[cells] = ends[inner];
      for (int l = 1; l <= finest; ++l) {
        const int nodes = 1 << (l - 1), step = cells >> l;
        double* own = values + group.offset[std::size_t(l)] + outer * nodes * inner + i;
        for (int k = 0; k < nodes; ++k) {
          const int at = (2 * k + 1) * step;
          const double before = own[k * inner];
          const double after = transformed<transform>(before, nodal[at - step], nodal[at + step]);
          nodal[at] = transform == LineTransform::hierarchise ? before : after;
          own[k * inner] = after;
        }
      }
    }
}

/// Long and narrow lines: the grid of each level is put together in order, so that a whole level is one loop over
/// adjacent values, both neighbours being `inner` apart.
template <LineTransform transform, int inner>
HWY_INLINE void narrowLines(const hbLineGroup& group, std::int64_t outer, double* values, double* grid, double* finer) {
  const hn::ScalableTag<double> d;
  const auto half = hn::Set(d, 0.5);
  const auto lanes = std::int64_t(hn::Lanes(d));
  std::copy_n(values + group.offset[0] + outer * 2 * inner, 2 * inner, grid);
  for (int l = 1; l <= group.finest; ++l) {
    const std::int64_t nodes = std::int64_t{1} << (l - 1), count = nodes * inner;
    double* own = values + group.offset[std::size_t(l)] + outer * count;
    std::int64_t j = 0;
    if constexpr (inner == 1)
      for (; j + lanes <= count; j += lanes) {
        const auto before = hn::LoadU(d, own + j), left = hn::LoadU(d, grid + j);
        const auto after = transformed<transform>(before, left, hn::LoadU(d, grid + j + 1), half);
        hn::StoreU(after, d, own + j);
        hn::StoreInterleaved2(left, transform == LineTransform::hierarchise ? before : after, d, finer + 2 * j);
      }
    for (; j < count; j += inner)
      for (int i = 0; i < inner; ++i) {
        const double before = own[j + i], left = grid[j + i];
        const double after = transformed<transform>(before, left, grid[j + inner + i]);
        own[j + i] = after;
        finer[2 * j + i] = left;
        finer[2 * j + inner + i] = transform == LineTransform::hierarchise ? before : after;
      }
    std::copy_n(grid + count, inner, finer + 2 * count);
    std::swap(grid, finer);
  }
}

template <LineTransform transform, int inner>
HWY_INLINE void lines(const hbLineGroup& group, std::int64_t first, std::int64_t last, double* values) {
  switch (group.finest) {
  case 0:
    return;
  case 1:
    return shortLines<transform, 1, inner>(group, first, last, values);
  case 2:
    return shortLines<transform, 2, inner>(group, first, last, values);
  case 3:
    return shortLines<transform, 3, inner>(group, first, last, values);
  default:
    break;
  }
  const std::size_t size = ((std::size_t{1} << group.finest) + 1) * inner;
  std::vector<double> scratch(2 * size);
  for (std::int64_t outer = first; outer < last; ++outer)
    narrowLines<transform, inner>(group, outer, values, scratch.data(), scratch.data() + size);
}

template <LineTransform transform>
HWY_INLINE void transformAll(const LinePart& part, double* values) {
  switch (part.group->inner) {
  case 1:
    return lines<transform, 1>(*part.group, part.first, part.last, values);
  case 2:
    return lines<transform, 2>(*part.group, part.first, part.last, values);
  case 4:
    return lines<transform, 4>(*part.group, part.first, part.last, values);
  default:
    for (std::int64_t outer = part.first; outer < part.last; ++outer) wideRows<transform>(part, outer, values);
  }
}

} // namespace

HWY_ATTR void hierarchiseLines(const LinePart& part, double* values) {
  transformAll<LineTransform::hierarchise>(part, values);
}
HWY_ATTR void dehierarchiseLines(const LinePart& part, double* values) {
  transformAll<LineTransform::dehierarchise>(part, values);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(hierarchiseLines);
HWY_EXPORT(dehierarchiseLines);
} // namespace

void transformLines(const LinePart& part, LineTransform transform, double* values) {
  if (transform == LineTransform::hierarchise)
    HWY_DYNAMIC_DISPATCH(hierarchiseLines)(part, values);
  else
    HWY_DYNAMIC_DISPATCH(dehierarchiseLines)(part, values);
}
} // namespace hb
#endif
