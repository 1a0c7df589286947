#include "glcombine/hbGlFormat.h"

#include <array>

namespace {
constexpr std::array<std::string_view, 4> kNames{"r8", "r16", "r16f", "r32f"};
constexpr std::array<int, 4> kBytes{1, 2, 2, 4};
} // namespace

std::string_view hb::glFormatName(hbGlFormat format) { return kNames[std::size_t(format)]; }
int hb::glFormatBytes(hbGlFormat format) { return kBytes[std::size_t(format)]; }
bool hb::isFixedPoint(hbGlFormat format) { return format == hbGlFormat::r8 || format == hbGlFormat::r16; }
