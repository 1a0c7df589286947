#pragma once

#include <map>
#include <span>
#include <string>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "glcombine/hbGlFunctions.h"

/// A vertex and a fragment shader, linked. The context must be current wherever it is used.
class hbGlProgram {
public:
  /// Turns of loops that a fragment may take: where all loops of a shader together have taken as many, Mesa's software
  /// renderer ends them, without an error (LP_MAX_TGSI_LOOP_ITERATIONS). The look at its condition that ends a loop is
  /// a turn, too, and as fragments run side by side, so is a loop in a branch that is not taken, or behind that look.
  static constexpr int kMostTurns = 65535;

  /// Keeps a reference to `gl`. Throws hbError with the log of what does not compile or link.
  hbGlProgram(const hbGlFunctions& gl, const std::string& vertexShader, const std::string& fragmentShader);
  ~hbGlProgram();
  hbGlProgram(const hbGlProgram&) = delete;
  hbGlProgram& operator=(const hbGlProgram&) = delete;

  void use() const { gl_.UseProgram(program_); }
  /// Sets a uniform of the program in use; one that the compiler found unnecessary is left out.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, const glm::vec3& value) const;
  void set(const char* name, const glm::mat3& value) const;
  /// The first elements of an array.
  void set(const char* name, std::span<const glm::vec3> values) const;
  void set(const char* name, std::span<const glm::vec4> values) const;
  /// Has a uniform block read what is bound to that GL_UNIFORM_BUFFER.
  void setBlock(const char* name, GLuint binding) const;

private:
  GLuint compile(GLenum kind, const std::string& source) const;
  GLint location(const char* name) const;

  const hbGlFunctions& gl_;
  GLuint program_ = 0;
  mutable std::map<std::string, GLint> locations_;
};
