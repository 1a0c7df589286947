#include "sparsegrid/kernels/hbDirectKernel.h"

#include "sparsegrid/hbHat.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbDirectKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "volume/kernels/hbPacket-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {

/// hbHat for a packet of points: the same operations in the same order.
template <class Real, bool withSlopes>
struct HatPacket {
  static constexpr int kSlots = hbHat<Real>::kSlots;
  PacketArray<std::int32_t> node[kSlots];
  PacketArray<Real> weight[kSlots];
  PacketArray<Real> slope[withSlopes ? kSlots : 1];

  template <class D, class V = hn::Vec<D>>
  HWY_INLINE void put(D d, int slot, hn::Vec<Indices<D>> nodes, V weights, V slopes) {
    hn::Store(nodes, Indices<D>(), node[slot].at);
    hn::Store(weights, d, weight[slot].at);
    if constexpr (withSlopes) hn::Store(slopes, d, slope[slot].at);
  }

  template <class D>
  HWY_INLINE void evaluate(D d, hn::Vec<D> u, const hbLatticeAxis& axis) {
    const Indices<D> di;
    const auto one = hn::Set(d, Real(1)), zero = hn::Zero(d);
    if (axis.flat) return put(d, 0, hn::Zero(di), one, zero);
    put(d, 0, hn::Zero(di), hn::Sub(one, u), hn::Neg(one));
    put(d, 1, hn::Set(di, 1), u, one);
    if (axis.finest == 0) return;
    const auto last = cellOf(d, u, std::int32_t{1} << (axis.finest - 1));
    for (int level = 1; level <= axis.finest; ++level) {
      const auto k = hn::ShiftRightSame(last, axis.finest - level);
      const auto scale = hn::Set(d, Real(std::int32_t{1} << level));
      const auto middle = toReal(d, hn::Add(hn::Add(k, k), hn::Set(di, 1)));
      const auto t = hn::Sub(hn::Mul(u, scale), middle);
      put(d, level + 1, k, hn::Sub(one, hn::Abs(t)), hn::IfThenElse(hn::Ge(t, zero), hn::Neg(scale), scale));
    }
  }
};

/// values[index] of every lane.
template <class D>
HWY_INLINE hn::Vec<D> gather(D d, const float* values, hn::Vec<Indices<D>> index) {
  const hn::Rebind<float, D> floats;
  const auto v = hn::GatherIndex(floats, values, index);
  if constexpr (std::is_same_v<hn::TFromD<D>, float>)
    return v;
  else
    return hn::PromoteTo(d, v);
}

template <class Real, bool withGradient>
HWY_INLINE void evaluate(const hbDirectTerms& terms, const float* surpluses, const hbPointsOf<Real>& points, Real* out,
                         const hbGradientsOf<Real>* gradient) {
  using D = PacketTag<Real>;
  using V = hn::Vec<D>;
  const D d;
  const Indices<D> di;
  const auto& [axisX, axisY, axisZ] = terms.axes;
  const int ends = axisX.flat ? 1 : 2; // nodes of level 0 along x
  HatPacket<Real, withGradient> x, y, z;
  for (Packets<Real> packet(points); packet.next();) {
    x.evaluate(d, clamped(d, packet.x, axisX.scale), axisX);
    y.evaluate(d, clamped(d, packet.y, axisY.scale), axisY);
    z.evaluate(d, clamped(d, packet.z, axisZ.scale), axisZ);
    WideSum<D> sum, sumX, sumY, sumZ;
    for (const hbDirectTerms::Row& row : terms.rows) {
      const auto line = hn::Add(hn::Mul(hn::Load(di, z.node[row.slotZ].at), hn::Set(di, row.nodesY)),
                                hn::Load(di, y.node[row.slotY].at));
      const std::int64_t* offsets = terms.offsets.data() + row.firstOffset;
      V inner = hn::Zero(d), innerSlope = inner;
      const auto add = [&](int slot, std::int64_t offset, hn::Vec<Indices<D>> index) HWY_ATTR {
        const V surplus = gather(d, surpluses + offset, index);
        inner = hn::Add(inner, hn::Mul(hn::Load(d, x.weight[slot].at), surplus));
        if constexpr (withGradient) innerSlope = hn::Add(innerSlope, hn::Mul(hn::Load(d, x.slope[slot].at), surplus));
      };
      const auto first = hn::Mul(line, hn::Set(di, ends));
      for (int end = 0; end < ends; ++end) add(end, offsets[0] + end, first);
      for (int level = 1; level < row.levels; ++level)
        add(level + 1, offsets[level], hn::Add(hn::ShiftLeftSame(line, level - 1), hn::Load(di, x.node[level + 1].at)));
      const V wy = hn::Load(d, y.weight[row.slotY].at), wz = hn::Load(d, z.weight[row.slotZ].at);
      sum.add(d, hn::Mul(hn::Mul(wy, wz), inner));
      if constexpr (withGradient) {
        sumX.add(d, hn::Mul(hn::Mul(wy, wz), innerSlope));
        sumY.add(d, hn::Mul(hn::Mul(hn::Load(d, y.slope[row.slotY].at), wz), inner));
        sumZ.add(d, hn::Mul(hn::Mul(wy, hn::Load(d, z.slope[row.slotZ].at)), inner));
      }
    }
    store(d, sum.get(d, 1.0), out + packet.first, packet.count);
    if constexpr (withGradient) {
      store(d, sumX.get(d, axisX.scale), gradient->dx.data() + packet.first, packet.count);
      store(d, sumY.get(d, axisY.scale), gradient->dy.data() + packet.first, packet.count);
      store(d, sumZ.get(d, axisZ.scale), gradient->dz.data() + packet.first, packet.count);
    }
  }
}

} // namespace

HWY_ATTR void directFloat(const hbDirectTerms& terms, const float* surpluses, const hbPoints& points, float* out,
                          const hbGradients* gradient) {
  if (gradient)
    evaluate<float, true>(terms, surpluses, points, out, gradient);
  else
    evaluate<float, false>(terms, surpluses, points, out, nullptr);
}
HWY_ATTR void directDouble(const hbDirectTerms& terms, const float* surpluses, const hbPoints64& points, double* out,
                           const hbGradients64* gradient) {
  if (gradient)
    evaluate<double, true>(terms, surpluses, points, out, gradient);
  else
    evaluate<double, false>(terms, surpluses, points, out, nullptr);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(directFloat);
HWY_EXPORT(directDouble);
} // namespace

void evaluateDirect(const hbDirectTerms& terms, const float* surpluses, const hbPoints& points, std::span<float> out,
                    const hbGradients* gradient) {
  HWY_DYNAMIC_DISPATCH(directFloat)(terms, surpluses, points, out.data(), gradient);
}
void evaluateDirect(const hbDirectTerms& terms, const float* surpluses, const hbPoints64& points, std::span<double> out,
                    const hbGradients64* gradient) {
  HWY_DYNAMIC_DISPATCH(directDouble)(terms, surpluses, points, out.data(), gradient);
}
} // namespace hb
#endif
