#include "sparsegrid/kernels/hbSemiNodalKernel.h"

#include "sparsegrid/hbIndexSet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbSemiNodalKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "volume/kernels/hbPacket-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {

/// The slots of one axis at the points of a packet.
template <class Real, bool withSlopes>
struct Hats {
  PacketArray<std::int32_t> node[hbIndexSet::kMaxLevel + 1];
  PairArray<Real> weight[hbIndexSet::kMaxLevel + 1];
  PairArray<Real> slope[withSlopes ? hbIndexSet::kMaxLevel + 1 : 1];

  template <class D, class V = hn::Vec<D>>
  HWY_INLINE void put(D d, int slot, hn::Vec<Indices<D>> nodes, V weights, V slopes) {
    hn::Store(nodes, Indices<D>(), node[slot].at);
    store(d, interleave(d, weights, weights), weight[slot]);
    if constexpr (withSlopes) store(d, interleave(d, slopes, slopes), slope[slot]);
  }

  template <class D>
  HWY_INLINE void evaluate(D d, hn::Vec<D> u, const hbSemiNodalTerms::Axis& axis) {
    const Indices<D> di;
    const auto one = hn::Set(d, Real(1));
    if (axis.baseCells == 0) return put(d, 0, hn::Zero(di), one, hn::Zero(d));
    const auto cells = hn::Set(d, Real(axis.baseCells));
    const auto cell = cellOf(d, u, axis.baseCells);
    const auto t = hn::Sub(hn::Mul(u, cells), toReal(d, cell));
    put(d, 0, cell, hn::Sub(one, t), hn::Neg(cells));
    put(d, 1, hn::Add(cell, hn::Set(di, 1)), t, cells);
    if (axis.finest < 2) return;
    // The nodes nest: a coarser level's is the finest one's, halved.
    const auto last = cellOf(d, u, std::int32_t{1} << (axis.finest - 1));
    for (int level = 2; level <= axis.finest; ++level) {
      const auto k = hn::ShiftRightSame(last, axis.finest - level);
      const auto scale = hn::Set(d, Real(std::int32_t{1} << level));
      const auto middle = toReal(d, hn::Add(hn::Add(k, k), hn::Set(di, 1)));
      const auto x = hn::Sub(hn::Mul(u, scale), middle);
      put(d, level, k, hn::Sub(one, hn::Abs(x)), hn::IfThenElse(hn::Ge(x, hn::Zero(d)), hn::Neg(scale), scale));
    }
  }
};

template <class Real, bool withGradient>
HWY_INLINE void evaluate(const hbSemiNodalTerms& terms, const float* values, const hbPointsOf<Real>& points, Real* out,
                         const hbGradientsOf<Real>* gradient) {
  using D = PacketTag<Real>;
  using V = hn::Vec<D>;
  const auto& [axisX, axisY, axisZ] = terms.axes;
  Hats<Real, withGradient> hatsY, hatsZ;
  // Places are computed for some terms before any value is loaded: they then come from memory lane by lane, which is
  // faster than taking vectors apart.
  constexpr std::size_t kTermsAtOnce = 32;
  PacketArray<std::int32_t> index[kTermsAtOnce];
  const D d;
  const Indices<D> di;
  const V zero = hn::Zero(d), one = hn::Set(d, Real(1));
  for (Packets<Real> packet(points); packet.next();) {
    const V x = clamped(d, packet.x, axisX.baseCells == 0 ? 0.0 : axisX.scale);
    hatsY.evaluate(d, clamped(d, packet.y, axisY.scale), axisY);
    hatsZ.evaluate(d, clamped(d, packet.z, axisZ.scale), axisZ);

    Pairs<V> sum{zero, zero}, sumX = sum, sumY = sum, sumZ = sum;
    for (const hbSemiNodalTerms::Group& group : terms.groups) {
      const std::int32_t cells = std::int32_t{1} << group.level;
      const auto cell = cellOf(d, x, cells);
      const auto nodes = hn::Set(di, cells + 1);
      // Summed over the group first: of one line's two values weighted by y and z, then the step along x.
      Pairs<V> line{zero, zero}, lineY = line, lineZ = line;
      for (std::size_t begin = group.begin; begin < group.end; begin += kTermsAtOnce) {
        const std::size_t end = std::min(begin + kTermsAtOnce, group.end);
        for (std::size_t i = begin; i < end; ++i) {
          const hbSemiNodalTerms::Term& term = terms.terms[i];
          const auto iy = hn::Load(di, hatsY.node[term.slotY].at), iz = hn::Load(di, hatsZ.node[term.slotZ].at);
          const auto lines = hn::Add(hn::Mul(iz, hn::Set(di, term.nodesY)), iy);
          hn::Store(hn::Add(hn::Mul(lines, nodes), cell), di, index[i - begin].at);
        }
        for (std::size_t i = begin; i < end; ++i) {
          const hbSemiNodalTerms::Term& term = terms.terms[i];
          const Pairs<V> two = adjacent(d, values + term.offset, index[i - begin].at);
          const Pairs<V> wy = load(d, hatsY.weight[term.slotY]), wz = load(d, hatsZ.weight[term.slotZ]);
          line = line + wy * wz * two;
          if constexpr (withGradient) {
            lineY = lineY + load(d, hatsY.slope[term.slotY]) * wz * two;
            lineZ = lineZ + wy * load(d, hatsZ.slope[term.slotZ]) * two;
          }
        }
      }
      const V t = hn::Sub(hn::Mul(x, hn::Set(d, Real(cells))), toReal(d, cell));
      const Pairs<V> weights = interleave(d, hn::Sub(one, t), t);
      sum = sum + weights * line;
      if constexpr (withGradient) {
        const V slope = hn::Set(d, Real(cells));
        sumX = sumX + interleave(d, hn::Neg(slope), slope) * line;
        sumY = sumY + weights * lineY;
        sumZ = sumZ + weights * lineZ;
      }
    }
    const auto finish = [&](const Pairs<V>& pairs, double scale, Real* to) HWY_ATTR {
      const V both = hn::Add(firsts(d, pairs), seconds(d, pairs));
      store(d, hn::Mul(inPointOrder(d, both), hn::Set(d, Real(scale))), to + packet.first, packet.count);
    };
    finish(sum, 1.0, out);
    if constexpr (withGradient) {
      finish(sumX, axisX.scale, gradient->dx.data());
      finish(sumY, axisY.scale, gradient->dy.data());
      finish(sumZ, axisZ.scale, gradient->dz.data());
    }
  }
}

} // namespace

HWY_ATTR void semiNodalFloat(const hbSemiNodalTerms& terms, const float* values, const hbPoints& points, float* out,
                             const hbGradients* gradient) {
  if (gradient)
    evaluate<float, true>(terms, values, points, out, gradient);
  else
    evaluate<float, false>(terms, values, points, out, nullptr);
}
HWY_ATTR void semiNodalDouble(const hbSemiNodalTerms& terms, const float* values, const hbPoints64& points, double* out,
                              const hbGradients64* gradient) {
  if (gradient)
    evaluate<double, true>(terms, values, points, out, gradient);
  else
    evaluate<double, false>(terms, values, points, out, nullptr);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(semiNodalFloat);
HWY_EXPORT(semiNodalDouble);
} // namespace

void evaluateSemiNodal(const hbSemiNodalTerms& terms, const float* values, const hbPoints& points, std::span<float> out,
                       const hbGradients* gradient) {
  HWY_DYNAMIC_DISPATCH(semiNodalFloat)(terms, values, points, out.data(), gradient);
}
void evaluateSemiNodal(const hbSemiNodalTerms& terms, const float* values, const hbPoints64& points,
                       std::span<double> out, const hbGradients64* gradient) {
  HWY_DYNAMIC_DISPATCH(semiNodalDouble)(terms, values, points, out.data(), gradient);
}
} // namespace hb
#endif
