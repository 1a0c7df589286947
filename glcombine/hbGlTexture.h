#pragma once

#include "glcombine/hbGlFunctions.h"

/// A texture's name, deleted with it; the context must be current then.
class hbGlTexture {
public:
  /// Keeps a reference to `gl`; bound to `target` (GL_TEXTURE_2D, GL_TEXTURE_3D) at once.
  hbGlTexture(const hbGlFunctions& gl, GLenum target) : gl_(&gl) {
    gl.GenTextures(1, &name_);
    gl.BindTexture(target, name_);
  }
  ~hbGlTexture() {
    if (name_ != 0) gl_->DeleteTextures(1, &name_);
  }
  hbGlTexture(hbGlTexture&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
  hbGlTexture& operator=(hbGlTexture&&) = delete;

  GLuint name() const { return name_; }

private:
  const hbGlFunctions* gl_;
  GLuint name_ = 0;
};
