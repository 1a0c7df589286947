#include "glcombine/hbGlTarget.h"

#include <fmt/format.h>

#include "glcombine/hbGlPixels.h"

hbGlTarget::hbGlTarget(const hbGlFunctions& gl, int width, int height, hbGlFormat format, int channels)
    : gl_(gl), width_(width), height_(height), channels_(channels), texture_(gl, GL_TEXTURE_2D) {
  gl.TexImage2D(GL_TEXTURE_2D, 0, hb::internalFormat(format, channels), width, height, 0, GL_RED, GL_FLOAT, nullptr);
  texture_.setFilter(GL_NEAREST);
  gl.GenFramebuffers(1, &name_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, name_);
  gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, texture_.name(), 0);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    gl.DeleteFramebuffers(1, &name_);
    throw hbError(fmt::format("glCheckFramebufferStatus: expected a target of the format {} that can be drawn into",
                              hb::glFormatName(format)));
  }
  clear(0.0F);
}

hbGlTarget::~hbGlTarget() { gl_.DeleteFramebuffers.quietly(1, &name_); }

void hbGlTarget::bind() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, name_);
  gl_.Viewport(0, 0, width_, height_);
}

void hbGlTarget::clear(float value) const {
  bind();
  gl_.ClearColor(value, value, value, value);
  gl_.Clear(GL_COLOR_BUFFER_BIT);
}

void hbGlTarget::read(std::vector<float>& out) const {
  out.resize(std::size_t(width_) * std::size_t(height_) * std::size_t(channels_));
  bind();
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width_, height_, channels_ == 4 ? GL_RGBA : GL_RED, GL_FLOAT, out.data());
}
