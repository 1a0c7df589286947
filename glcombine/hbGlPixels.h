#pragma once

#include "glcombine/hbGlFormat.h"
#include "glcombine/hbGlFunctions.h"

namespace hb {

/// OpenGL's name of a format, with 1 channel, or 4 (r32f alone).
constexpr GLint internalFormat(hbGlFormat format, int channels = 1) {
  if (channels == 4) return GL_RGBA32F;
  return format == hbGlFormat::r8     ? GL_R8
         : format == hbGlFormat::r16  ? GL_R16
         : format == hbGlFormat::r16f ? GL_R16F
                                      : GL_R32F;
}

} // namespace hb
