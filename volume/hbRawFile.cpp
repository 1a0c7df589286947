#include "volume/hbRawFile.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbMappedFile.h"

std::optional<hbRawLayout> hb::rawLayoutFromName(const std::filesystem::path& path) {
  if (path.extension() != ".raw") return {};
  const std::string stem = path.stem().string();
  const std::size_t typeAt = stem.rfind('_');
  if (typeAt == std::string::npos || typeAt == 0) return {};
  const std::size_t sizesAt = stem.rfind('_', typeAt - 1);
  if (sizesAt == std::string::npos) return {};

  hbRawLayout layout;
  const std::string_view typeName = std::string_view(stem).substr(typeAt + 1);
  constexpr std::array kTypes{hbSampleType::int8,  hbSampleType::uint8,  hbSampleType::int16,   hbSampleType::uint16,
                              hbSampleType::int32, hbSampleType::uint32, hbSampleType::float32, hbSampleType::float64};
  const auto* type =
      std::find_if(kTypes.begin(), kTypes.end(), [&](hbSampleType t) { return sampleTypeName(t) == typeName; });
  if (type == kTypes.end()) return {};
  layout.type = *type;

  const char* at = stem.data() + sizesAt + 1;
  const char* const end = stem.data() + typeAt;
  for (int d = 0; d < 3; ++d) {
    if (d > 0 && (at == end || *at++ != 'x')) return {};
    const auto [next, status] = std::from_chars(at, end, layout.size[d]);
    if (status == std::errc::result_out_of_range)
      throw hbError(fmt::format("{}: expected sizes below 2^63 in the name, found {}", path.string(),
                                std::string_view(at, std::size_t(next - at))));
    if (status != std::errc() || layout.size[d] < 0) return {};
    at = next;
  }
  if (at != end) return {};
  return layout;
}

std::string hb::rawFileName(const std::string& stem, const hbSize3& size, hbSampleType type) {
  return fmt::format("{}_{}x{}x{}_{}.raw", stem, size.x, size.y, size.z, sampleTypeName(type));
}

hbVolume hb::openRawFile(const std::filesystem::path& path, const hbRawLayout& layout) {
  hbGeometry geometry;
  geometry.size = layout.size;
  geometry.spacing = layout.spacing;
  geometry.validate(path.string());
  std::string axes = layout.axisOrder;
  std::sort(axes.begin(), axes.end());
  if (axes != "xyz")
    throw hbError(
        fmt::format("{}: expected an axis order such as xyz or zyx, found '{}'", path.string(), layout.axisOrder));
  if (layout.components < 1)
    throw hbError(fmt::format("{}: expected at least one component, found {}", path.string(), layout.components));

  const bool packed = layout.interleaving == hbRawLayout::Interleaving::packed;
  const auto sampleSize = std::uint64_t(sampleBytes(layout.type));
  std::uint64_t expected = 0;
  if (__builtin_mul_overflow(std::uint64_t(geometry.samples()), std::uint64_t(layout.components) * sampleSize,
                             &expected) ||
      __builtin_add_overflow(expected, layout.offset, &expected) || expected > std::uint64_t(INT64_MAX))
    throw hbError(fmt::format("{}: expected fewer than 2^63 bytes, found a layout of {} x {} x {} samples of {} {}",
                              path.string(), layout.size.x, layout.size.y, layout.size.z, layout.components,
                              sampleTypeName(layout.type)));
  std::uint64_t found = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, found);
  if (found != expected)
    throw hbError(fmt::format("{}: expected {} bytes ({} + {} x {} x {} samples of {} {}), found {}", path.string(),
                              expected, layout.offset, layout.size.x, layout.size.y, layout.size.z, layout.components,
                              sampleTypeName(layout.type), found));

  hbVolume::Layout strides;
  std::int64_t step = packed ? layout.components : 1;
  for (const char axis : layout.axisOrder) {
    strides.stride[std::size_t(axis - 'x')] = step;
    step *= layout.size[axis - 'x'];
  }
  strides.componentStride = packed ? 1 : step;
  strides.byteSwapped = layout.bigEndian && sampleSize > 1;
  return hbVolume(geometry, layout.type, layout.components, {file, file.get() + layout.offset}, strides);
}
