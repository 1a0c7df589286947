#pragma once

#include "glcombine/hbGlFunctions.h"

/// Draws rectangles, by default over the whole target. The context must be current wherever it is used.
class hbGlQuad {
public:
  /// For fragment shaders that need nothing but gl_FragCoord. Others know the corners by gl_VertexID as well.
  static constexpr const char* kVertexShader = R"(#version 330 core
void main() { gl_Position = vec4(2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0); }
)";

  /// Keeps a reference to `gl`.
  explicit hbGlQuad(const hbGlFunctions& gl) : gl_(gl) { gl.GenVertexArrays(1, &vertices_); }
  ~hbGlQuad() { gl_.DeleteVertexArrays.quietly(1, &vertices_); }
  hbGlQuad(const hbGlQuad&) = delete;
  hbGlQuad& operator=(const hbGlQuad&) = delete;

  /// For the draws that follow.
  void bind() const { gl_.BindVertexArray(vertices_); }
  void draw() const { gl_.DrawArrays(GL_TRIANGLE_STRIP, 0, 4); }
  /// Several of them; gl_InstanceID says which.
  void draw(int count) const { gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count); }

private:
  const hbGlFunctions& gl_;
  GLuint vertices_ = 0;
};
