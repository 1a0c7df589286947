#pragma once

#include "glcombine/hbGlFunctions.h"

/// A texture's name, deleted with it; the context must be current then.
class hbGlTexture {
public:
  /// Keeps a reference to `gl`; bound to `target` (GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_BUFFER) at once.
  hbGlTexture(const hbGlFunctions& gl, GLenum target) : gl_(&gl), target_(target) {
    gl.GenTextures(1, &name_);
    gl.BindTexture(target, name_);
  }
  ~hbGlTexture() {
    if (name_ != 0) gl_->DeleteTextures.quietly(1, &name_);
  }
  hbGlTexture(hbGlTexture&& other) noexcept
      : gl_(other.gl_), target_(other.target_), name_(std::exchange(other.name_, 0)) {}
  hbGlTexture& operator=(hbGlTexture&&) = delete;

  GLuint name() const { return name_; }

  /// Makes it what a sampler of that unit (0 to 15) reads.
  void bind(int unit) const {
    gl_->ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    gl_->BindTexture(target_, name_);
  }
  /// How a GL_TEXTURE_2D or GL_TEXTURE_3D is read: GL_NEAREST or GL_LINEAR, its border texels going on outside.
  void setFilter(GLint filter) const {
    gl_->BindTexture(target_, name_);
    for (const GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_->TexParameteri(target_, which, filter);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      gl_->TexParameteri(target_, wrap, GL_CLAMP_TO_EDGE);
  }

private:
  const hbGlFunctions* gl_;
  GLenum target_;
  GLuint name_ = 0;
};
