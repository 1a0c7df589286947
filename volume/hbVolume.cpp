#include "volume/hbVolume.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/common.hpp>

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

void hbVolume::adviseScatteredReads() const { hb::adviseScatteredReads(data_); }

void hbVolume::releasePages() const { hb::releasePages(data_); }

void hbVolume::releasePlanes(std::int64_t first, std::int64_t last) const {
  const hbSize3 lastSample{geometry_.size.x - 1, geometry_.size.y - 1, last};
  std::int64_t end = (components_ - 1) * layout_.componentStride + 1;
  for (int d = 0; d < 3; ++d) end += lastSample[d] * layout_.stride[std::size_t(d)];
  const std::int64_t begin = first * layout_.stride[2], bytes = hb::sampleBytes(type_);
  hb::releasePages(data_, std::uint64_t(begin * bytes), std::uint64_t((end - begin) * bytes));
}

hbValueMap hbVolume::chooseValueMap() const {
  const bool integer = type_ != hbSampleType::float32 && type_ != hbSampleType::float64;
  const bool plain = slope_ == 1.0 && intercept_ == 0.0;
  if (plain && integer && hb::sampleBytes(type_) < 4) return {};
  // All samples of a small volume; of a larger one at most 40 an axis, first and last included.
  constexpr std::int64_t kAll = std::int64_t{1} << 24, kPerAxis = 40;
  hbSize3 count = geometry_.size;
  if (geometry_.samples() > kAll / components_) count = glm::min(count, hbSize3(kPerAxis));
  const auto at = [&](int d, std::int64_t i) {
    return count[d] == 1 ? 0 : i * (geometry_.size[d] - 1) / (count[d] - 1);
  };
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo;
  std::vector<double> line(static_cast<std::size_t>(count.x));
  for (std::int64_t k = 0; k < count.z; ++k) {
    for (int c = 0; c < components_; ++c)
      for (std::int64_t j = 0; j < count.y; ++j) {
        if (count.x == geometry_.size.x)
          row(0, at(1, j), at(2, k), c, line);
        else
          for (std::int64_t i = 0; i < count.x; ++i) line[std::size_t(i)] = value(at(0, i), at(1, j), at(2, k), c);
        for (const double v : line) {
          if (!std::isfinite(v)) continue;
          lo = std::min(lo, v);
          hi = std::max(hi, v);
        }
      }
    if (count != geometry_.size) releasePlanes(at(2, k), at(2, k));
  }
  if (!(lo <= hi)) return {};

  const double largest = std::max(std::abs(lo), std::abs(hi));
  const double middle = 0.5 * lo + 0.5 * hi, halfWidth = 0.5 * hi - 0.5 * lo; // neither overflows
  hbValueMap map;
  // Centre where a float's 24 bits would be spent on the common offset: neighbouring integers (which differ by the
  // slope) fall together, or a small signal rides on a large constant. 32-bit floats have lost what their own bits did
  // not hold, but sums of them need not lose more; they are less than twice the offset, a float itself, and more than
  // half of it, so that their differences from it are exact; known only where all were looked at.
  const bool neighboursMeet = integer && largest > 0x1p24 * std::abs(slope_);
  const bool isExactAnyway = plain && (integer || (type_ == hbSampleType::float32 && count != geometry_.size));
  const bool offsetDominates = largest > 8.0 * halfWidth && !isExactAnyway;
  if (neighboursMeet || offsetDominates)
    map.offset = !plain || type_ == hbSampleType::float64 ? middle
                 : integer                                ? std::nearbyint(middle)
                                                          : double(float(middle));
  // Scale by a power of two where a float's exponent does not reach; leave room for differences and sums over the grid.
  const double rest = std::max(std::abs(lo - map.offset), std::abs(hi - map.offset));
  constexpr double kRoom = 1e30;
  if (rest > kRoom) map.scale = std::exp2(std::min(std::ceil(std::log2(rest)), 1023.0));
  return map;
}
