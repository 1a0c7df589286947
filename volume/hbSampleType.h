#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// The type of a volume's samples on disk. The numbers are those of the `.hbv` file.
enum class hbSampleType : std::uint8_t {
  int8 = 1,
  uint8 = 2,
  int16 = 3,
  uint16 = 4,
  int32 = 5,
  uint32 = 6,
  float32 = 7,
  float64 = 8
};

namespace hb {

/// Bytes of one sample.
std::size_t sampleBytes(hbSampleType type);

/// "int8", "uint8", ..., "float64".
std::string_view sampleTypeName(hbSampleType type);

/// The type of that name ("float" and "double" are accepted too); throws hbError for another name.
hbSampleType sampleTypeFromName(std::string_view name);

/// Calls f(T{}) with the C++ type of `type`; returns what f returns.
template <class F>
decltype(auto) withSampleType(hbSampleType type, F&& f) {
  switch (type) {
  case hbSampleType::int8:
    return f(std::int8_t{});
  case hbSampleType::uint8:
    return f(std::uint8_t{});
  case hbSampleType::int16:
    return f(std::int16_t{});
  case hbSampleType::uint16:
    return f(std::uint16_t{});
  case hbSampleType::int32:
    return f(std::int32_t{});
  case hbSampleType::uint32:
    return f(std::uint32_t{});
  case hbSampleType::float32:
    return f(float{});
  case hbSampleType::float64:
    break;
  }
  return f(double{});
}

} // namespace hb
