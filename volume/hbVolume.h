#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "volume/hbGeometry.h"
#include "volume/hbSampleType.h"
#include "volume/hbValueMap.h"

/// Samples on a regular grid: integers or floats, one or more components, in memory or mapped from a file.
///
/// Immutable, and cheap to copy (copies share the samples). The data value of a sample is `slope * sample + intercept`.
class hbVolume {
public:
  /// How samples lie in memory, in samples (not bytes) from the first one.
  struct Layout {
    std::array<std::int64_t, 3> stride{}; ///< From one sample to the next along x, y, z.
    std::int64_t componentStride = 1;     ///< From one component to the next.
    bool byteSwapped = false;             ///< Big-endian data.

    /// x fastest, then y, then z; the components of a sample side by side.
    static Layout packed(const hbSize3& size, int components);
    bool operator==(const Layout&) const = default;
  };

  /// Shares `data` (aligned for the type or not), which must hold every sample the layout reaches. Throws hbError for
  /// an invalid geometry or less than one component.
  hbVolume(const hbGeometry& geometry, hbSampleType type, int components, std::shared_ptr<const std::byte> data,
           const Layout& layout);

  /// Takes `samples`, packed (x fastest; components side by side): size x*y*z*components.
  template <class T>
  static hbVolume fromSamples(const hbGeometry& geometry, std::vector<T> samples, int components = 1);

  const hbGeometry& geometry() const { return geometry_; }
  hbSampleType type() const { return type_; }
  int components() const { return components_; }
  const Layout& layout() const { return layout_; }
  const std::byte* data() const { return data_.get(); }

  double slope() const { return slope_; }
  double intercept() const { return intercept_; }
  void setSlopeIntercept(double slope, double intercept);

  /// One name a component; "" where the file gave none.
  const std::vector<std::string>& componentNames() const { return componentNames_; }
  void setComponentNames(std::vector<std::string> names);
  void setGeometry(const hbGeometry& geometry); ///< Same sizes; throws hbError otherwise.

  /// The data value of a sample, in 64 bits. O(1).
  double value(std::int64_t x, std::int64_t y, std::int64_t z, int component = 0) const;

  /// The data values of the samples (x0 + i, y, z), i < out.size(), in 64 bits.
  void row(std::int64_t x0, std::int64_t y, std::int64_t z, int component, std::span<double> out) const;

  /// For a volume in a mapped file: expect reads here and there, not from front to back (see hb::adviseScatteredReads).
  void adviseScatteredReads() const;
  /// For a volume in a mapped file: forget what was read, so that it does not stay in memory (see hb::releasePages).
  void releasePages() const;
  /// The same for the planes first <= z <= last, and what lies between their samples.
  void releasePlanes(std::int64_t first, std::int64_t last) const;

  /// How 32-bit floats should stand for the data values (see hbValueMap): the identity, except where floats would take
  /// neighbouring values for one (wide integers, a small signal on a large constant) or do not reach (beyond 1e30).
  /// Looks at all samples of a volume of up to 2^24, and at 40 an axis of a larger one, whose 32-bit floats are not
  /// centred: of a sample far from those seen, the offset would take bits that the identity keeps.
  hbValueMap chooseValueMap() const;

private:
  hbGeometry geometry_;
  hbSampleType type_;
  int components_;
  std::shared_ptr<const std::byte> data_;
  Layout layout_;
  double slope_ = 1.0;
  double intercept_ = 0.0;
  std::vector<std::string> componentNames_;
};

namespace hb {

template <class T>
constexpr hbSampleType sampleTypeOf() {
  if constexpr (std::is_same_v<T, std::int8_t>)
    return hbSampleType::int8;
  else if constexpr (std::is_same_v<T, std::uint8_t>)
    return hbSampleType::uint8;
  else if constexpr (std::is_same_v<T, std::int16_t>)
    return hbSampleType::int16;
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return hbSampleType::uint16;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return hbSampleType::int32;
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return hbSampleType::uint32;
  else if constexpr (std::is_same_v<T, float>)
    return hbSampleType::float32;
  else {
    static_assert(std::is_same_v<T, double>, "not a sample type");
    return hbSampleType::float64;
  }
}

/// Reads a T at any address, reversing its bytes where `Swapped`.
template <class T, bool Swapped>
T loadSample(const std::byte* at) {
  std::array<std::byte, sizeof(T)> bytes;
  T sample;
  if constexpr (Swapped) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = at[sizeof(T) - 1 - i];
    __builtin_memcpy(&sample, bytes.data(), sizeof(T));
  } else {
    __builtin_memcpy(&sample, at, sizeof(T));
  }
  return sample;
}

} // namespace hb

template <class T>
hbVolume hbVolume::fromSamples(const hbGeometry& geometry, std::vector<T> samples, int components) {
  assert(std::int64_t(samples.size()) == geometry.samples() * components);
  auto owner = std::make_shared<const std::vector<T>>(std::move(samples));
  const auto* first = reinterpret_cast<const std::byte*>(owner->data());
  return hbVolume(geometry, hb::sampleTypeOf<T>(), components, {std::move(owner), first},
                  Layout::packed(geometry.size, components));
}
