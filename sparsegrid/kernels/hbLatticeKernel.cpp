#include "sparsegrid/kernels/hbLatticeKernel.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbLatticeKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;

/// sum += weight * values, or = where `first`.
HWY_INLINE void weightedRow(const double* values, std::int64_t count, double weight, bool first, double* sum) {
  const Tag d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto w = hn::Set(d, weight);
  std::int64_t i = 0;
  if (first) {
    for (; i + lanes <= count; i += lanes) hn::StoreU(hn::Mul(w, hn::LoadU(d, values + i)), d, sum + i);
    for (; i < count; ++i) sum[i] = weight * values[i];
  } else {
    for (; i + lanes <= count; i += lanes)
      hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(w, hn::LoadU(d, values + i))), d, sum + i);
    for (; i < count; ++i) sum[i] += weight * values[i];
  }
}

/// The nodal values of the next level: those of the coarser one, and between them surplus plus mean.
HWY_INLINE void refine(const double* coarse, const double* surpluses, std::int64_t cells, double* fine) {
  const Tag d;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto half = hn::Set(d, 0.5);
  std::int64_t k = 0;
  for (; k + lanes <= cells; k += lanes) {
    const auto left = hn::LoadU(d, coarse + k);
    const auto mean = hn::Mul(half, hn::Add(left, hn::LoadU(d, coarse + k + 1)));
    hn::StoreInterleaved2(left, hn::Add(hn::LoadU(d, surpluses + k), mean), d, fine + 2 * k);
  }
  for (; k < cells; ++k) {
    fine[2 * k] = coarse[k];
    fine[2 * k + 1] = surpluses[k] + 0.5 * (coarse[k] + coarse[k + 1]);
  }
  fine[2 * cells] = coarse[cells];
}

} // namespace

HWY_ATTR void addWeightedTo(const float* values, std::int64_t count, double weight, double* sum) {
  const Tag d;
  const hn::Rebind<float, Tag> floats;
  const auto lanes = std::int64_t(hn::Lanes(d));
  const auto w = hn::Set(d, weight);
  std::int64_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(w, hn::PromoteTo(d, hn::LoadU(floats, values + i)))), d, sum + i);
  for (; i < count; ++i) sum[i] += weight * double(values[i]);
}

HWY_ATTR const double* rowOf(const hbLatticeRows& rows, const double* plane, const std::int32_t* node,
                             const double* weight, double* surpluses, double* line, double* finer) {
  for (std::size_t l = 0; l < rows.levels.size(); ++l) {
    const hbLatticeRows::Level& level = rows.levels[l];
    double* sum = l == 0 ? line : surpluses;
    bool first = true;
    for (std::size_t p = level.begin; p < level.end; ++p) {
      const hbLatticeRows::Part& part = rows.parts[p];
      if (weight[part.slotY] == 0.0) continue;
      weightedRow(plane + part.offset + node[part.slotY] * level.count, level.count, weight[part.slotY], first, sum);
      first = false;
    }
    if (first) std::fill_n(sum, level.count, 0.0);
    if (l == 0) continue;
    refine(line, surpluses, level.count, finer);
    std::swap(line, finer);
  }
  return line;
}

HWY_ATTR void roundRow(const double* values, std::int64_t count, float* out) {
  const Tag d;
  const hn::Rebind<float, Tag> floats;
  const auto lanes = std::int64_t(hn::Lanes(d));
  std::int64_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(hn::DemoteTo(floats, hn::LoadU(d, values + i)), floats, out + i);
  for (; i < count; ++i) out[i] = float(values[i]);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(addWeightedTo);
HWY_EXPORT(rowOf);
HWY_EXPORT(roundRow);
} // namespace

void addWeighted(const float* values, std::int64_t count, double weight, double* sum) {
  HWY_DYNAMIC_DISPATCH(addWeightedTo)(values, count, weight, sum);
}
const double* latticeRow(const hbLatticeRows& rows, const double* plane, const std::int32_t* node, const double* weight,
                         std::span<double> surpluses, std::span<double> scratch) {
  return HWY_DYNAMIC_DISPATCH(rowOf)(rows, plane, node, weight, surpluses.data(), scratch.data(),
                                     scratch.data() + scratch.size() / 2);
}
void roundToFloats(const double* values, std::int64_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(roundRow)(values, count, out);
}
} // namespace hb
#endif
