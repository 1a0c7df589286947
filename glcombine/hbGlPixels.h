#pragma once

#include "glcombine/hbGlFormat.h"
#include "glcombine/hbGlFunctions.h"

namespace hb {

/// OpenGL's name of a format.
constexpr GLint internalFormat(hbGlFormat format) {
  return format == hbGlFormat::r8     ? GL_R8
         : format == hbGlFormat::r16  ? GL_R16
         : format == hbGlFormat::r16f ? GL_R16F
                                      : GL_R32F;
}

} // namespace hb
