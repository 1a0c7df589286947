#include "volume/kernels/hbTrilinearKernel.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/kernels/hbTrilinearKernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "volume/hbVolume.h"
#include "volume/kernels/hbPacket-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hb::HWY_NAMESPACE {
namespace {

using D = PacketTag<float>;
using V = hn::Vec<D>;

// The lanes of a packet as 64-bit floats, the lower and the upper half of them.
#if HWY_TARGET == HWY_SCALAR
using Wide = hn::Rebind<double, D>;
using Halves = Pairs<hn::Vec<Wide>>;
HWY_INLINE Halves widen(V v) { return {hn::PromoteTo(Wide(), v), hn::PromoteTo(Wide(), v)}; }
// Not DemoteTo, whose infinities are finite here.
HWY_INLINE V narrow(const Halves& v) { return hn::Set(D(), float(hn::GetLane(v.lower))); }
#else
using Wide = hn::Rebind<double, hn::Half<D>>;
using Halves = Pairs<hn::Vec<Wide>>;
HWY_INLINE Halves widen(V v) {
  const hn::Half<D> half;
  return {hn::PromoteTo(Wide(), hn::LowerHalf(half, v)), hn::PromoteTo(Wide(), hn::UpperHalf(half, v))};
}
HWY_INLINE V narrow(const Halves& v) {
  const hn::Half<D> half;
  return hn::Combine(D(), hn::DemoteTo(half, v.upper), hn::DemoteTo(half, v.lower));
}
#endif
HWY_INLINE Halves everywhere(double v) { return {hn::Set(Wide(), v), hn::Set(Wide(), v)}; }

/// The cells of an axis that hold the points, and where in them.
struct Cells {
  Halves index; ///< Whole numbers.
  V t;

  // A coordinate times the number of cells is exact in 64 bits.
  HWY_INLINE Cells(V coordinate, std::int64_t size) : index(everywhere(0.0)), t(hn::Zero(D())) {
    if (size == 1) return;
    const Halves position = widen(clamped(D(), coordinate, 1.0)) * everywhere(double(size - 1));
    const auto last = hn::Set(Wide(), double(size - 2));
    index = {hn::Min(hn::Floor(position.lower), last), hn::Min(hn::Floor(position.upper), last)};
    t = narrow(position - index);
  }
};

/// The samples at a place and the next one along x.
struct Two {
  V lower, upper;
};

#if HWY_TARGET == HWY_SCALAR
template <class T>
HWY_INLINE Two twoSamples(const std::byte* first, const std::int64_t* offset) {
  const std::byte* at = first + *offset;
  return {hn::Set(D(), float(loadSample<T, false>(at))), hn::Set(D(), float(loadSample<T, false>(at + sizeof(T))))};
}
#else
/// 64 bits from each place, two floats.
template <class DF>
HWY_INLINE hn::Vec<DF> floatPairs(DF d, const std::byte* first, const std::int64_t* offset) {
  if constexpr (hn::MaxLanes(DF()) == 2) {
    const hn::Repartition<std::uint8_t, DF> bytes; // floats would have to be aligned
    return hn::BitCast(d, hn::LoadU(bytes, reinterpret_cast<const std::uint8_t*>(first + *offset)));
  } else {
    const hn::Half<DF> half;
    return hn::Combine(d, floatPairs(half, first, offset + hn::MaxLanes(half) / 2), floatPairs(half, first, offset));
  }
}

template <class T>
HWY_INLINE Two twoSamples(const std::byte* first, const std::int64_t* offset) {
  const D d;
  if constexpr (std::is_same_v<T, float>) {
    const V lower = floatPairs(d, first, offset), upper = floatPairs(d, first, offset + hn::MaxLanes(d) / 2);
    return {hn::ConcatEven(d, upper, lower), hn::ConcatOdd(d, upper, lower)};
  } else {
    // Both integers in one, low one first, with the second's sign.
    using Both = std::conditional_t<sizeof(T) == 1, std::int16_t, std::int32_t>;
    constexpr int kBits = 8 * sizeof(T), kRest = 32 - kBits;
    const hn::Rebind<std::int32_t, D> di;
    PacketArray<std::int32_t> both;
    for (std::size_t i = 0; i < hn::MaxLanes(d); ++i)
      both.at[i] = std::int32_t(loadSample<Both, false>(first + offset[i])) << (32 - 2 * kBits);
    const auto packed = hn::Load(di, both.at);
    const auto low = hn::ShiftLeft<kBits>(packed);
    if constexpr (std::is_signed_v<T>)
      return {hn::ConvertTo(d, hn::ShiftRight<kRest>(low)), hn::ConvertTo(d, hn::ShiftRight<kRest>(packed))};
    const hn::Rebind<std::uint32_t, D> du;
    const auto positive = [&](auto v) HWY_ATTR {
      return hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<kRest>(hn::BitCast(du, v))));
    };
    return {positive(low), positive(packed)};
  }
}
#endif

HWY_INLINE V lerp(V a, V b, V t) { return hn::Add(a, hn::Mul(t, hn::Sub(b, a))); }

/// Between two samples along x.
template <class T, bool isMapped>
HWY_INLINE V alongX(const hbTrilinearSamples& samples, const std::byte* first, const std::int64_t* offset, V t) {
  Two two = twoSamples<T>(first, offset);
  if constexpr (isMapped) {
    const Halves a = everywhere(samples.a), b = everywhere(samples.b);
    two.lower = narrow(a * widen(two.lower) + b);
    two.upper = narrow(a * widen(two.upper) + b);
  }
  return lerp(two.lower, two.upper, t);
}

template <class T, bool isMapped>
HWY_INLINE void interpolate(const hbTrilinearSamples& samples, const hbPoints& points, float* out) {
  const hn::Rebind<std::int64_t, Wide> wideIndex;
  const Halves strideX = everywhere(double(sizeof(T))), strideY = everywhere(double(samples.strideY)),
               strideZ = everywhere(double(samples.strideZ));
  const std::int64_t toY = samples.size.y > 1 ? samples.strideY : 0, toZ = samples.size.z > 1 ? samples.strideZ : 0;
  PacketArray<std::int64_t> offset;
  for (Packets<float> packet(points); packet.next();) {
    const Cells x(packet.x, samples.size.x), y(packet.y, samples.size.y), z(packet.z, samples.size.z);
    // Exact: no memory has 2^53 bytes.
    const Halves place = x.index * strideX + y.index * strideY + z.index * strideZ;
    hn::Store(hn::ConvertTo(wideIndex, place.lower), wideIndex, offset.at);
#if HWY_TARGET != HWY_SCALAR
    hn::Store(hn::ConvertTo(wideIndex, place.upper), wideIndex, offset.at + hn::MaxLanes(wideIndex));
#endif
    const std::byte* first = samples.first;
    const V x00 = alongX<T, isMapped>(samples, first, offset.at, x.t),
            x10 = alongX<T, isMapped>(samples, first + toY, offset.at, x.t),
            x01 = alongX<T, isMapped>(samples, first + toZ, offset.at, x.t),
            x11 = alongX<T, isMapped>(samples, first + toY + toZ, offset.at, x.t);
    store(D(), lerp(lerp(x00, x10, y.t), lerp(x01, x11, y.t), z.t), out + packet.first, packet.count);
  }
}

template <class T>
HWY_INLINE void interpolate(const hbTrilinearSamples& samples, const hbPoints& points, float* out) {
  if (samples.a == 1.0 && samples.b == 0.0)
    interpolate<T, false>(samples, points, out);
  else
    interpolate<T, true>(samples, points, out);
}

} // namespace

HWY_ATTR void trilinear(const hbTrilinearSamples& samples, const hbPoints& points, float* out) {
  switch (samples.type) {
  case hbSampleType::int8:
    return interpolate<std::int8_t>(samples, points, out);
  case hbSampleType::uint8:
    return interpolate<std::uint8_t>(samples, points, out);
  case hbSampleType::int16:
    return interpolate<std::int16_t>(samples, points, out);
  case hbSampleType::uint16:
    return interpolate<std::uint16_t>(samples, points, out);
  default:
    return interpolate<float>(samples, points, out);
  }
}

} // namespace hb::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hb {
namespace {
HWY_EXPORT(trilinear);
} // namespace

bool hasTrilinearKernel(hbSampleType type) {
  return type == hbSampleType::float32 || type == hbSampleType::int8 || type == hbSampleType::uint8 ||
         type == hbSampleType::int16 || type == hbSampleType::uint16;
}

void evaluateTrilinear(const hbTrilinearSamples& samples, const hbPoints& points, std::span<float> out) {
  HWY_DYNAMIC_DISPATCH(trilinear)(samples, points, out.data());
}
} // namespace hb
#endif
