#include "glcombine/hbGlContext.h"

#include <fmt/format.h>

#include "glcombine/hbEglContext.h"
#include "glcombine/hbGlFunctions.h"
#include "glcombine/hbOsMesaContext.h"

std::unique_ptr<hbGlContext> hbGlContext::create(Kind kind) {
  if (kind == Kind::osmesa) return std::make_unique<hbOsMesaContext>();
  if (kind == Kind::egl) return std::make_unique<hbEglContext>();
  std::string reasons;
  try {
    return std::make_unique<hbOsMesaContext>();
  } catch (const hbError& error) {
    reasons = error.what();
  }
  try {
    return std::make_unique<hbEglContext>();
  } catch (const hbError& error) {
    throw hbError(fmt::format("OpenGL: expected OSMesa or EGL; {}; {}", reasons, error.what()));
  }
}

void hbGlContext::initialise(const std::function<void*(const char*)>& load) {
  functions_ = std::make_shared<const hbGlFunctions>(load);
  const auto text = [&](GLenum name) {
    const auto* characters = reinterpret_cast<const char*>(gl().GetString(name));
    return std::string(characters ? characters : "");
  };
  vendor_ = text(GL_VENDOR);
  renderer_ = text(GL_RENDERER);
  version_ = text(GL_VERSION);
  GLint size = 0;
  gl().GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &size);
  maxTextureSize3d_ = size;
}
