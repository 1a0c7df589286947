#include "sparsegrid/kernels/hbCombinationKernel.h"

#include "sparsegrid/hbIndexSet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sparsegrid/kernels/hbCombinationKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "volume/kernels/hbPacket-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {

/// The cells of one axis at the points of a packet, a level each: the lower node and the place between it and the upper
/// one.
template <class Real>
struct Cells {
  PacketArray<std::int32_t> node[hbIndexSet::kMaxLevel + 1];
  PairArray<Real> place[hbIndexSet::kMaxLevel + 1];

  template <class D>
  HWY_INLINE void evaluate(D d, hn::Vec<D> u, const hbLatticeAxis& axis) {
    const Indices<D> di;
    // Sizes are 2^l + 1, so u * 2^l is exact and the cells nest: every grid sees a node of the sparse grid as its own.
    for (int level = 0; level <= axis.finest; ++level) {
      const std::int32_t cells = std::int32_t{1} << level;
      const auto cell = axis.flat ? hn::Zero(di) : cellOf(d, u, cells);
      const auto t = axis.flat ? hn::Zero(d) : hn::Sub(hn::Mul(u, hn::Set(d, Real(cells))), toReal(d, cell));
      hn::Store(cell, di, node[level].at);
      store(d, interleave(d, t, t), place[level]);
    }
  }
};

template <class V>
HWY_INLINE Pairs<V> lerp(const Pairs<V>& a, const Pairs<V>& b, const Pairs<V>& t) {
  return a + t * (b - a);
}

template <class Real, bool withGradient>
HWY_INLINE void evaluate(const hbCombinationTerms& terms, const float* values, const hbPointsOf<Real>& points,
                         Real* out, const hbGradientsOf<Real>* gradient) {
  using D = PacketTag<Real>;
  using V = hn::Vec<D>;
  const D d;
  const Indices<D> di;
  const auto& [axisX, axisY, axisZ] = terms.axes;
  Cells<Real> x, y, z;
  PacketArray<std::int32_t> index;
  for (Packets<Real> packet(points); packet.next();) {
    x.evaluate(d, clamped(d, packet.x, axisX.scale), axisX);
    y.evaluate(d, clamped(d, packet.y, axisY.scale), axisY);
    z.evaluate(d, clamped(d, packet.z, axisZ.scale), axisZ);
    WideSum<D> sum, sumX, sumY, sumZ;
    for (const hbCombinationTerms::Grid& grid : terms.grids) {
      const auto [lx, ly, lz] = std::array{grid.levels.x, grid.levels.y, grid.levels.z};
      const auto alongY = hn::Mul(hn::Load(di, y.node[ly].at), hn::Set(di, std::int32_t(grid.strideY)));
      const auto alongZ = hn::Mul(hn::Load(di, z.node[lz].at), hn::Set(di, std::int32_t(grid.strideZ)));
      hn::Store(hn::Add(hn::Load(di, x.node[lx].at), hn::Add(alongY, alongZ)), di, index.at);
      const float* corner = values + grid.offset;
      const auto v00 = adjacent(d, corner, index.at), v10 = adjacent(d, corner + grid.strideY, index.at),
                 v01 = adjacent(d, corner + grid.strideZ, index.at),
                 v11 = adjacent(d, corner + grid.strideY + grid.strideZ, index.at);
      const auto ty = load(d, y.place[ly]), tz = load(d, z.place[lz]);
      const auto v0 = lerp(v00, v10, ty), v1 = lerp(v01, v11, ty);
      const V tx = firsts(d, load(d, x.place[lx]));
      const V coefficient = hn::Set(d, Real(grid.coefficient));
      const auto alongX = [&](const Pairs<V>& two) HWY_ATTR {
        const V a = firsts(d, two), b = seconds(d, two);
        return hn::Add(a, hn::Mul(tx, hn::Sub(b, a)));
      };
      const auto v = lerp(v0, v1, tz);
      sum.add(d, hn::Mul(coefficient, alongX(v)));
      if constexpr (withGradient) {
        // Differences across the cell, times the cells an axis; powers of two, like the coefficients, or nearly so.
        const auto cells = [&](const hbLatticeAxis& axis, int level) HWY_ATTR {
          return hn::Mul(coefficient, hn::Set(d, axis.flat ? Real(0) : Real(std::int32_t{1} << level)));
        };
        sumX.add(d, hn::Mul(cells(axisX, lx), hn::Sub(seconds(d, v), firsts(d, v))));
        sumY.add(d, hn::Mul(cells(axisY, ly), alongX(lerp(v10 - v00, v11 - v01, tz))));
        sumZ.add(d, hn::Mul(cells(axisZ, lz), alongX(v1 - v0)));
      }
    }
    store(d, inPointOrder(d, sum.get(d, 1.0)), out + packet.first, packet.count);
    if constexpr (withGradient) {
      store(d, inPointOrder(d, sumX.get(d, axisX.scale)), gradient->dx.data() + packet.first, packet.count);
      store(d, inPointOrder(d, sumY.get(d, axisY.scale)), gradient->dy.data() + packet.first, packet.count);
      store(d, inPointOrder(d, sumZ.get(d, axisZ.scale)), gradient->dz.data() + packet.first, packet.count);
    }
  }
}

} // namespace

HWY_ATTR void combinationFloat(const hbCombinationTerms& terms, const float* values, const hbPoints& points, float* out,
                               const hbGradients* gradient) {
  if (gradient)
    evaluate<float, true>(terms, values, points, out, gradient);
  else
    evaluate<float, false>(terms, values, points, out, nullptr);
}
HWY_ATTR void combinationDouble(const hbCombinationTerms& terms, const float* values, const hbPoints64& points,
                                double* out, const hbGradients64* gradient) {
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
HWY_EXPORT(combinationFloat);
HWY_EXPORT(combinationDouble);
} // namespace

void evaluateCombination(const hbCombinationTerms& terms, const float* values, const hbPoints& points,
                         std::span<float> out, const hbGradients* gradient) {
  HWY_DYNAMIC_DISPATCH(combinationFloat)(terms, values, points, out.data(), gradient);
}
void evaluateCombination(const hbCombinationTerms& terms, const float* values, const hbPoints64& points,
                         std::span<double> out, const hbGradients64* gradient) {
  HWY_DYNAMIC_DISPATCH(combinationDouble)(terms, values, points, out.data(), gradient);
}
} // namespace hb
#endif
