#include "glcombine/hbGlProgram.h"

#include <algorithm>

#include <fmt/format.h>

namespace {

template <class GetInteger, class GetLog>
std::string logOf(GLuint object, const GetInteger& integer, const GetLog& log) {
  GLint length = 0;
  integer(object, GL_INFO_LOG_LENGTH, &length);
  std::string text(std::size_t(std::max(length, 1)), '\0');
  log(object, GLsizei(text.size()), nullptr, text.data());
  text.resize(text.find('\0') == std::string::npos ? text.size() : text.find('\0'));
  return text;
}

} // namespace

hbGlProgram::hbGlProgram(const hbGlFunctions& gl, const std::string& vertexShader, const std::string& fragmentShader)
    : gl_(gl) {
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertexShader);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragmentShader);
  program_ = gl_.CreateProgram();
  for (const GLuint shader : {vertex, fragment}) {
    gl_.AttachShader(program_, shader);
    gl_.DeleteShader(shader); // when the program is
  }
  gl_.LinkProgram(program_);
  GLint linked = 0;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked) return;
  const std::string log = logOf(program_, gl_.GetProgramiv, gl_.GetProgramInfoLog);
  gl_.DeleteProgram(program_);
  throw hbError(fmt::format("glLinkProgram: expected a program that links, found: {}", log));
}

hbGlProgram::~hbGlProgram() { gl_.DeleteProgram.quietly(program_); }

GLuint hbGlProgram::compile(GLenum kind, const std::string& source) const {
  const GLuint shader = gl_.CreateShader(kind);
  const char* text = source.c_str();
  gl_.ShaderSource(shader, 1, &text, nullptr);
  gl_.CompileShader(shader);
  GLint compiled = 0;
  gl_.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  const std::string log = logOf(shader, gl_.GetShaderiv, gl_.GetShaderInfoLog);
  gl_.DeleteShader(shader);
  throw hbError(fmt::format("glCompileShader: expected a {} shader that compiles, found: {}",
                            kind == GL_VERTEX_SHADER ? "vertex" : "fragment", log));
}

GLint hbGlProgram::location(const char* name) const {
  const auto [entry, isNew] = locations_.try_emplace(name, -1);
  if (isNew) entry->second = gl_.GetUniformLocation(program_, name);
  return entry->second;
}

void hbGlProgram::set(const char* name, int value) const { gl_.Uniform1i(location(name), value); }
void hbGlProgram::set(const char* name, float value) const { gl_.Uniform1f(location(name), value); }
void hbGlProgram::set(const char* name, const glm::vec3& value) const {
  gl_.Uniform3f(location(name), value.x, value.y, value.z);
}
void hbGlProgram::set(const char* name, const glm::mat3& value) const {
  gl_.UniformMatrix3fv(location(name), 1, GL_FALSE, &value[0][0]);
}
void hbGlProgram::set(const char* name, std::span<const glm::vec3> values) const {
  gl_.Uniform3fv(location(name), GLsizei(values.size()), &values[0].x);
}
void hbGlProgram::set(const char* name, std::span<const glm::vec4> values) const {
  gl_.Uniform4fv(location(name), GLsizei(values.size()), &values[0].x);
}
void hbGlProgram::setBlock(const char* name, GLuint binding) const {
  const GLuint block = gl_.GetUniformBlockIndex(program_, name);
  if (block != GL_INVALID_INDEX) gl_.UniformBlockBinding(program_, block, binding);
}
