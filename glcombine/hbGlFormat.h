#pragma once

#include <cstdint>
#include <string_view>

/// How numbers are kept in textures and render targets of one channel.
enum class hbGlFormat : std::uint8_t {
  r8,   ///< Fixed-point in [0,1], 8 bits.
  r16,  ///< The same, 16 bits.
  r16f, ///< Floats of 16 bits.
  r32f  ///< Floats of 32 bits.
};

namespace hb {

std::string_view glFormatName(hbGlFormat format);
/// Bytes of a texel.
int glFormatBytes(hbGlFormat format);
/// Whether it holds [0,1] only, and clamps what is outside.
bool isFixedPoint(hbGlFormat format);

} // namespace hb
