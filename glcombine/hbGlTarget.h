#pragma once

#include <vector>

#include "glcombine/hbGlFormat.h"
#include "glcombine/hbGlTexture.h"

/// A picture to draw into, off screen, of one channel or of four (r32f alone). The context must be current wherever it
/// is used.
class hbGlTarget {
public:
  /// Keeps a reference to `gl`; cleared to 0. Throws hbError where the driver cannot draw into this format.
  hbGlTarget(const hbGlFunctions& gl, int width, int height, hbGlFormat format, int channels = 1);
  ~hbGlTarget();
  hbGlTarget(const hbGlTarget&) = delete;
  hbGlTarget& operator=(const hbGlTarget&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }

  /// What is drawn from now on is drawn here.
  void bind() const;
  void clear(float value) const;
  /// All pixels as floats, a pixel's channels together, rows as OpenGL has them: the first drawn at y = -1 comes first.
  /// `out` takes width * height * channels.
  void read(std::vector<float>& out) const;

  /// What was drawn, to be read by shaders (GL_NEAREST); not while it is drawn into.
  const hbGlTexture& texture() const { return texture_; }

private:
  const hbGlFunctions& gl_;
  int width_, height_, channels_;
  hbGlTexture texture_;
  GLuint name_ = 0;
};
