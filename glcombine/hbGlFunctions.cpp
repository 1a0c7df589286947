#include "glcombine/hbGlFunctions.h"

#include <fmt/format.h>

void hb::throwOnGlError(const char* call, GLenum error) {
  if (error == GL_NO_ERROR) return;
  const char* name = error == GL_INVALID_ENUM                    ? "GL_INVALID_ENUM"
                     : error == GL_INVALID_VALUE                 ? "GL_INVALID_VALUE"
                     : error == GL_INVALID_OPERATION             ? "GL_INVALID_OPERATION"
                     : error == GL_INVALID_FRAMEBUFFER_OPERATION ? "GL_INVALID_FRAMEBUFFER_OPERATION"
                     : error == GL_OUT_OF_MEMORY                 ? "GL_OUT_OF_MEMORY"
                                                                 : "an unknown error";
  throw hbError(fmt::format("{}: expected no OpenGL error, found {} (0x{:x})", call, name, error));
}
