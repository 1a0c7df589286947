#pragma once

#include <cstdint>
#include <string_view>

/// What a ray does with the values along it.
enum class hbMode : std::uint8_t {
  xray, ///< The line integral of the field, in value x world length.
  mip,  ///< The greatest sample.
  iso,  ///< The first crossing of the iso-value, with Lambertian shading.
  dvr,  ///< Emission and absorption by the transfer function.
  slice ///< The value on a plane.
};

namespace hb {

std::string_view modeName(hbMode mode);

/// The mode of that name; throws hbError for another one.
hbMode modeFromName(std::string_view name);

} // namespace hb
