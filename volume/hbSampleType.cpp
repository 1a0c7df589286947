#include "volume/hbSampleType.h"

#include <array>
#include <utility>

#include <fmt/format.h>

#include "volume/hbError.h"

namespace {

constexpr std::array<std::pair<std::string_view, hbSampleType>, 10> kNames{{{"int8", hbSampleType::int8},
                                                                            {"uint8", hbSampleType::uint8},
                                                                            {"int16", hbSampleType::int16},
                                                                            {"uint16", hbSampleType::uint16},
                                                                            {"int32", hbSampleType::int32},
                                                                            {"uint32", hbSampleType::uint32},
                                                                            {"float32", hbSampleType::float32},
                                                                            {"float64", hbSampleType::float64},
                                                                            {"float", hbSampleType::float32},
                                                                            {"double", hbSampleType::float64}}};

} // namespace

std::size_t hb::sampleBytes(hbSampleType type) {
  return withSampleType(type, [](auto sample) { return sizeof(sample); });
}

std::string_view hb::sampleTypeName(hbSampleType type) {
  for (const auto& [name, value] : kNames)
    if (value == type) return name;
  return "unknown";
}

hbSampleType hb::sampleTypeFromName(std::string_view name) {
  for (const auto& [known, value] : kNames)
    if (known == name) return value;
  throw hbError(fmt::format(
      "sample type: expected int8, uint8, int16, uint16, int32, uint32, float32 or float64, found '{}'", name));
}
