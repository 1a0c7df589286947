#include "volume/hbVolume.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbMappedFile.h"

hbVolume::Layout hbVolume::Layout::packed(const hbSize3& size, int components) {
  return {{components, components * size.x, components * size.x * size.y}, 1, false};
}

hbVolume::hbVolume(const hbGeometry& geometry, hbSampleType type, int components, std::shared_ptr<const std::byte> data,
                   const Layout& layout)
    : geometry_(geometry), type_(type), components_(components), data_(std::move(data)), layout_(layout) {
  geometry.validate("volume");
  if (components < 1) throw hbError(fmt::format("volume: expected at least one component, found {}", components));
  componentNames_.resize(std::size_t(components));
}

void hbVolume::setSlopeIntercept(double slope, double intercept) {
  if (!std::isfinite(slope) || slope == 0.0 || !std::isfinite(intercept))
    throw hbError(fmt::format("volume: expected a finite slope other than 0 and a finite intercept, found {} and {}",
                              slope, intercept));
  slope_ = slope;
  intercept_ = intercept;
}

void hbVolume::setComponentNames(std::vector<std::string> names) {
  if (int(names.size()) != components_)
    throw hbError(fmt::format("volume: expected {} component names, found {}", components_, names.size()));
  componentNames_ = std::move(names);
}

void hbVolume::setGeometry(const hbGeometry& geometry) {
  geometry.validate("volume");
  if (geometry.size != geometry_.size) throw hbError("volume: a new geometry must keep the sizes");
  geometry_ = geometry;
}

void hbVolume::row(std::int64_t x0, std::int64_t y, std::int64_t z, int component, std::span<double> out) const {
  hb::withSampleType(type_, [&](auto tag) {
    using T = decltype(tag);
    const std::int64_t step = layout_.stride[0] * std::int64_t(sizeof(T));
    const std::byte* at =
        data_.get() + std::int64_t(sizeof(T)) * (x0 * layout_.stride[0] + y * layout_.stride[1] +
                                                 z * layout_.stride[2] + component * layout_.componentStride);
    for (std::size_t i = 0; i < out.size(); ++i, at += step) {
      const T sample = layout_.byteSwapped ? hb::loadSample<T, true>(at) : hb::loadSample<T, false>(at);
      out[i] = slope_ * double(sample) + intercept_;
    }
  });
}

double hbVolume::value(std::int64_t x, std::int64_t y, std::int64_t z, int component) const {
  double result = 0.0;
  row(x, y, z, component, {&result, 1});
  return result;
}

void hbVolume::releasePages() const { hb::releaseMapped(data_); }

hbValueMap hbVolume::chooseValueMap() const {
  if (type_ != hbSampleType::int32 && type_ != hbSampleType::uint32 && type_ != hbSampleType::float64) return {};
  // At most 40 samples an axis, first and last included.
  constexpr std::int64_t kPerAxis = 40;
  hbSize3 count;
  for (int d = 0; d < 3; ++d) count[d] = std::min(kPerAxis, geometry_.size[d]);
  const auto at = [&](int d, std::int64_t i) {
    return count[d] == 1 ? 0 : i * (geometry_.size[d] - 1) / (count[d] - 1);
  };
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo;
  for (int c = 0; c < components_; ++c)
    for (std::int64_t k = 0; k < count.z; ++k)
      for (std::int64_t j = 0; j < count.y; ++j)
        for (std::int64_t i = 0; i < count.x; ++i) {
          const double v = value(at(0, i), at(1, j), at(2, k), c);
          if (!std::isfinite(v)) continue;
          lo = std::min(lo, v);
          hi = std::max(hi, v);
        }
  if (!(lo <= hi)) return {};

  const double largest = std::max(std::abs(lo), std::abs(hi));
  const double width = hi - lo; // may be infinite for values near the largest double
  hbValueMap map;
  // Centre where a float's 24 bits would be spent on the common offset.
  const bool wideInteger = type_ != hbSampleType::float64 && largest > 0x1p24;
  const bool offsetDominates = type_ == hbSampleType::float64 && largest > 4.0 * width;
  if (wideInteger || offsetDominates) map.offset = std::nearbyint(lo + 0.5 * width);
  if (type_ == hbSampleType::float64 && map.offset != 0.0 && std::abs(map.offset) < 0x1p20)
    map.offset = lo + 0.5 * width;
  // Scale by a power of two where a float's exponent does not reach; leave room for sums over the grid.
  const double rest = std::max(std::abs(lo - map.offset), std::abs(hi - map.offset));
  if (rest > 1e30) map.scale = std::exp2(std::ceil(std::log2(rest)));
  return map;
}
