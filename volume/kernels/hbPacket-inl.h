// What the kernels share, compiled once for each instruction set (see Highway's foreach_target.h): points in packets,
// and the two adjacent values around each of them.

#if defined(HBVOL_VOLUME_KERNELS_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HBVOL_VOLUME_KERNELS_PACKET_INL_H
#undef HBVOL_VOLUME_KERNELS_PACKET_INL_H
#else
#define HBVOL_VOLUME_KERNELS_PACKET_INL_H
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <hwy/highway.h>

#include "volume/hbField.h"

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// No fused multiply-add anywhere in the kernels: with it, values would depend on the instruction set.

constexpr std::size_t kMaxLanes = 16;

/// A packet is one vector of points.
template <class Real>
using PacketTag = hn::CappedTag<Real, kMaxLanes>;
template <class D>
using Indices = hn::Rebind<std::int32_t, D>;

/// One number a lane.
template <class T>
struct alignas(64) PacketArray {
  T at[kMaxLanes];
};

// *Pair layout*: two vectors for the lanes of a packet, each with two adjacent entries for each of half of them. Within
// every block of 16 bytes `lower` has the points of the first half of the block, `upper` those of the second:
// InterleaveLower and InterleaveUpper give it from two vectors, ConcatEven and ConcatOdd take it apart into *half
// order* (first the points of `lower`, then those of `upper`), and inPointOrder() puts that right.

template <class V>
struct Pairs {
  V lower, upper;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Pairs<V> interleave(D d, V even, V odd) {
#if HWY_TARGET == HWY_SCALAR
  (void)d;
  return {even, odd}; // one lane: the pair is in two vectors
#else
  return {hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd)};
#endif
}
/// The first and the second entries of all pairs, in half order.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V firsts(D d, const Pairs<V>& pairs) {
#if HWY_TARGET == HWY_SCALAR
  (void)d;
  return pairs.lower;
#else
  return hn::ConcatEven(d, pairs.upper, pairs.lower);
#endif
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE V seconds(D d, const Pairs<V>& pairs) {
#if HWY_TARGET == HWY_SCALAR
  (void)d;
  return pairs.upper;
#else
  return hn::ConcatOdd(d, pairs.upper, pairs.lower);
#endif
}

/// A weight a lane, kept in pair layout.
template <class T>
struct alignas(64) PairArray {
  T lower[kMaxLanes], upper[kMaxLanes];
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE void store(D d, const Pairs<V>& pairs, PairArray<hn::TFromD<D>>& to) {
  hn::Store(pairs.lower, d, to.lower);
  hn::Store(pairs.upper, d, to.upper);
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE Pairs<V> load(D d, const PairArray<hn::TFromD<D>>& from) {
  return {hn::Load(d, from.lower), hn::Load(d, from.upper)};
}

template <class V>
HWY_INLINE Pairs<V> operator+(const Pairs<V>& a, const Pairs<V>& b) {
  return {hn::Add(a.lower, b.lower), hn::Add(a.upper, b.upper)};
}
template <class V>
HWY_INLINE Pairs<V> operator-(const Pairs<V>& a, const Pairs<V>& b) {
  return {hn::Sub(a.lower, b.lower), hn::Sub(a.upper, b.upper)};
}
template <class V>
HWY_INLINE Pairs<V> operator*(const Pairs<V>& a, const Pairs<V>& b) {
  return {hn::Mul(a.lower, b.lower), hn::Mul(a.upper, b.upper)};
}

/// Lanes of 16 bytes.
template <class Real>
constexpr std::size_t kBlock = 16 / sizeof(Real);

#if HWY_TARGET == HWY_SCALAR
template <class D>
HWY_INLINE Pairs<hn::Vec<D>> adjacent(D d, const float* values, const std::int32_t* index) {
  using Real = hn::TFromD<D>;
  return {hn::Set(d, Real(values[*index])), hn::Set(d, Real(values[*index + 1]))};
}
template <class D>
HWY_INLINE hn::Vec<D> inPointOrder(D, hn::Vec<D> halves) {
  return halves;
}
#else
// Two adjacent values are one load of 64 bits. Loads and shuffles of their own are faster than gather instructions on
// the processors at hand (doc/results.md).
template <class D>
HWY_INLINE hn::Vec<D> adjacentPairs(D d, const float* values, const std::int32_t* index) {
  const hn::Half<D> half;
  constexpr bool oneBlock = hn::MaxLanes(D()) == kBlock<hn::TFromD<D>>;
  if constexpr (!oneBlock)
    return hn::Combine(d, adjacentPairs(half, values, index + hn::MaxLanes(half)), adjacentPairs(half, values, index));
  else if constexpr (std::is_same_v<hn::TFromD<D>, float>)
    return hn::Combine(d, hn::LoadU(half, values + index[1]), hn::LoadU(half, values + index[0]));
  else
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, D>(), values + index[0]));
}

/// values[index] and values[index + 1] of every lane.
template <class D>
HWY_INLINE Pairs<hn::Vec<D>> adjacent(D d, const float* values, const std::int32_t* index) {
  return {adjacentPairs(d, values, index), adjacentPairs(d, values, index + kBlock<hn::TFromD<D>> / 2)};
}

/// From half order to the order of the points.
template <class D>
HWY_INLINE hn::Vec<D> inPointOrder(D d, hn::Vec<D> halves) {
  using Real = hn::TFromD<D>;
  constexpr std::size_t block = kBlock<Real>;
  alignas(64) Real from[kMaxLanes], to[kMaxLanes];
  hn::Store(halves, d, from);
  for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) {
    const std::size_t inBlock = i % block, upper = inBlock / (block / 2);
    to[i] = from[i / block * (block / 2) + inBlock % (block / 2) + upper * (hn::MaxLanes(d) / 2)];
  }
  return hn::Load(d, to);
}

#endif

/// The integer below a number that is not negative.
template <class D>
HWY_INLINE hn::Vec<Indices<D>> toIndex(hn::Vec<D> v) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>)
    return hn::ConvertTo(Indices<D>(), v);
  else
    return hn::DemoteTo(Indices<D>(), v);
}
template <class D>
HWY_INLINE hn::Vec<D> toReal(D d, hn::Vec<Indices<D>> v) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>)
    return hn::ConvertTo(d, v);
  else
    return hn::PromoteTo(d, v);
}

/// Coordinates clamped to [0,1] (NaN to 0), times `scale`.
template <class D>
HWY_INLINE hn::Vec<D> clamped(D d, hn::Vec<D> u, double scale) {
  using Real = hn::TFromD<D>;
  const auto zero = hn::Zero(d);
  u = hn::IfThenElse(hn::Gt(u, zero), hn::Min(u, hn::Set(d, Real(1))), zero);
  return hn::Mul(u, hn::Set(d, Real(scale)));
}

/// The cell of `cells` equal ones that holds each u of [0,1] (1 itself: the last one).
template <class D>
HWY_INLINE hn::Vec<Indices<D>> cellOf(D d, hn::Vec<D> u, std::int32_t cells) {
  using Real = hn::TFromD<D>;
  return hn::Min(toIndex<D>(hn::Mul(u, hn::Set(d, Real(cells)))), hn::Set(Indices<D>(), cells - 1));
}

// (Constructors are written out: those of the compiler's own would not be compiled for the instruction set.)

/// A sum in 64 bits of vectors of either type.
template <class D>
struct Sum64 {
  hn::Vec<D> sum;
  HWY_INLINE Sum64() : sum(hn::Zero(D())) {}
  HWY_INLINE void add(D, hn::Vec<D> v) { sum = hn::Add(sum, v); }
  /// Times `factor`, rounded once.
  HWY_INLINE hn::Vec<D> get(D d, double factor) const { return hn::Mul(sum, hn::Set(d, factor)); }
};
template <class D>
struct Sum32 {
#if HWY_TARGET == HWY_SCALAR
  double sum = 0.0;
  HWY_INLINE void add(D, hn::Vec<D> v) { sum += double(hn::GetLane(v)); }
  HWY_INLINE hn::Vec<D> get(D d, double factor) const { return hn::Set(d, float(sum * factor)); }
#else
  using Wide = hn::Rebind<double, hn::Half<D>>;
  hn::Vec<Wide> lower, upper;
  HWY_INLINE Sum32() : lower(hn::Zero(Wide())), upper(hn::Zero(Wide())) {}
  HWY_INLINE void add(D, hn::Vec<D> v) {
    lower = hn::Add(lower, hn::PromoteTo(Wide(), hn::LowerHalf(v)));
    upper = hn::Add(upper, hn::PromoteTo(Wide(), hn::UpperHalf(hn::Half<D>(), v)));
  }
  HWY_INLINE hn::Vec<D> get(D d, double factor) const {
    const hn::Half<D> half;
    const auto f = hn::Set(Wide(), factor);
    return hn::Combine(d, hn::DemoteTo(half, hn::Mul(upper, f)), hn::DemoteTo(half, hn::Mul(lower, f)));
  }
#endif
};
template <class D>
using WideSum = std::conditional_t<std::is_same_v<hn::TFromD<D>, float>, Sum32<D>, Sum64<D>>;

/// Walks through points packet by packet: `while (packets.next()) ...`. Lanes past the last point repeat it.
template <class Real>
struct Packets {
  using D = PacketTag<Real>;
  hn::Vec<D> x, y, z;               ///< As they were given.
  std::size_t first = 0, count = 0; ///< Of the points in this packet.

  HWY_INLINE explicit Packets(const hbPointsOf<Real>& points)
      : x(hn::Zero(D())), y(hn::Zero(D())), z(hn::Zero(D())), points_(points) {}
  HWY_INLINE bool next() {
    const D d;
    const std::size_t lanes = hn::Lanes(d);
    first += count;
    if (first >= points_.size()) return false;
    count = std::min(lanes, points_.size() - first);
    const auto load = [&](std::span<const Real> from) HWY_ATTR {
      if (count == lanes) return hn::LoadU(d, from.data() + first);
      PacketArray<Real> padded;
      for (std::size_t i = 0; i < lanes; ++i) padded.at[i] = from[first + std::min(i, count - 1)];
      return hn::Load(d, padded.at);
    };
    x = load(points_.x);
    y = load(points_.y);
    z = load(points_.z);
    return true;
  }

private:
  hbPointsOf<Real> points_;
};

/// Stores the lanes that stand for points.
template <class D>
HWY_INLINE void store(D d, hn::Vec<D> v, hn::TFromD<D>* to, std::size_t count) {
  if (count == hn::Lanes(d)) return hn::StoreU(v, d, to);
  PacketArray<hn::TFromD<D>> all;
  hn::Store(v, d, all.at);
  std::copy_n(all.at, count, to);
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif // HBVOL_VOLUME_KERNELS_PACKET_INL_H
