#pragma once

#include "glcombine/hbGlFunctions.h"

/// Values that shaders read, uploaded once; deleted with it. The context must be current wherever it is used.
class hbGlBuffer {
public:
  /// Keeps a reference to `gl`; for `target` (GL_TEXTURE_BUFFER, GL_UNIFORM_BUFFER), to which it stays bound.
  hbGlBuffer(const hbGlFunctions& gl, GLenum target, const void* data, std::size_t bytes) : gl_(gl) {
    gl.GenBuffers(1, &name_);
    gl.BindBuffer(target, name_);
    gl.BufferData(target, GLsizeiptr(bytes), data, GL_STATIC_DRAW);
  }
  ~hbGlBuffer() { gl_.DeleteBuffers.quietly(1, &name_); }
  hbGlBuffer(const hbGlBuffer&) = delete;
  hbGlBuffer& operator=(const hbGlBuffer&) = delete;

  GLuint name() const { return name_; }

private:
  const hbGlFunctions& gl_;
  GLuint name_ = 0;
};
