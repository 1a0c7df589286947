#pragma once

#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#define GL_GLEXT_PROTOTYPES 1 // for their types; nothing is linked
#include <GL/glcorearb.h>

#include "volume/hbError.h"

namespace hb {

/// Throws hbError naming the call unless `error` is GL_NO_ERROR.
void throwOnGlError(const char* call, GLenum error);

} // namespace hb

/// One OpenGL function of one context. After every call its error is looked at and thrown.
template <class Signature>
class hbGlFunction;
template <class Result, class... Arguments>
class hbGlFunction<Result(Arguments...)> {
public:
  using Pointer = Result(APIENTRY*)(Arguments...);
  using Load = std::function<void*(const char*)>;

  /// Throws hbError where the context has no such function.
  hbGlFunction(const char* name, const Load& load) : name_(name), call_(reinterpret_cast<Pointer>(load(name))) {
    error_ = reinterpret_cast<GLenum(APIENTRY*)()>(load("glGetError"));
    if (!call_ || !error_) throw hbError(std::string("OpenGL: expected the function ") + name + ", found none");
  }

  Result operator()(Arguments... arguments) const {
    if constexpr (std::is_void_v<Result>) {
      call_(arguments...);
      hb::throwOnGlError(name_, error_());
    } else {
      const Result result = call_(arguments...);
      hb::throwOnGlError(name_, error_());
      return result;
    }
  }

  /// Without looking at the error: for what is deleted, perhaps while another error is thrown.
  void quietly(Arguments... arguments) const noexcept { call_(arguments...); }

private:
  const char* name_;
  Pointer call_;
  GLenum(APIENTRY* error_)();
};

// What this folder calls of OpenGL 3.3 (core), without its prefix.
#define HBVOL_GL_FUNCTIONS(X)                                                                                          \
  X(ActiveTexture)                                                                                                     \
  X(AttachShader)                                                                                                      \
  X(BindBuffer)                                                                                                        \
  X(BindBufferBase)                                                                                                    \
  X(BindFramebuffer)                                                                                                   \
  X(BindTexture)                                                                                                       \
  X(BindVertexArray)                                                                                                   \
  X(BlendEquation)                                                                                                     \
  X(BlendFunc)                                                                                                         \
  X(BufferData)                                                                                                        \
  X(CheckFramebufferStatus)                                                                                            \
  X(Clear)                                                                                                             \
  X(ClearColor)                                                                                                        \
  X(CompileShader)                                                                                                     \
  X(CreateProgram)                                                                                                     \
  X(CreateShader)                                                                                                      \
  X(DeleteBuffers)                                                                                                     \
  X(DeleteFramebuffers)                                                                                                \
  X(DeleteProgram)                                                                                                     \
  X(DeleteShader)                                                                                                      \
  X(DeleteTextures)                                                                                                    \
  X(DeleteVertexArrays)                                                                                                \
  X(Disable)                                                                                                           \
  X(DrawArrays)                                                                                                        \
  X(DrawArraysInstanced)                                                                                               \
  X(Enable)                                                                                                            \
  X(Finish)                                                                                                            \
  X(FramebufferTexture)                                                                                                \
  X(GenBuffers)                                                                                                        \
  X(GenFramebuffers)                                                                                                   \
  X(GenTextures)                                                                                                       \
  X(GenVertexArrays)                                                                                                   \
  X(GetIntegerv)                                                                                                       \
  X(GetProgramInfoLog)                                                                                                 \
  X(GetProgramiv)                                                                                                      \
  X(GetShaderInfoLog)                                                                                                  \
  X(GetShaderiv)                                                                                                       \
  X(GetString)                                                                                                         \
  X(GetUniformBlockIndex)                                                                                              \
  X(GetUniformLocation)                                                                                                \
  X(IsTexture)                                                                                                         \
  X(LinkProgram)                                                                                                       \
  X(PixelStorei)                                                                                                       \
  X(ReadBuffer)                                                                                                        \
  X(ReadPixels)                                                                                                        \
  X(ShaderSource)                                                                                                      \
  X(TexBuffer)                                                                                                         \
  X(TexImage2D)                                                                                                        \
  X(TexImage3D)                                                                                                        \
  X(TexParameteri)                                                                                                     \
  X(Uniform1f)                                                                                                         \
  X(Uniform1i)                                                                                                         \
  X(Uniform3f)                                                                                                         \
  X(Uniform3fv)                                                                                                        \
  X(Uniform4fv)                                                                                                        \
  X(UniformBlockBinding)                                                                                               \
  X(UniformMatrix3fv)                                                                                                  \
  X(UseProgram)                                                                                                        \
  X(Viewport)

/// The functions of one context: gl.TexImage3D(...) and so on. Only the thread in which the context is current may call
/// them.
class hbGlFunctions {
  std::function<void*(const char*)> load_;

public:
  /// `load` gives the address of a function by its full name, or nullptr. Throws hbError where one is missing.
  explicit hbGlFunctions(std::function<void*(const char*)> load) : load_(std::move(load)) {}

#define HBVOL_GL_FUNCTION(name) hbGlFunction<std::remove_pointer_t<decltype(&gl##name)>> name{"gl" #name, load_};
  HBVOL_GL_FUNCTIONS(HBVOL_GL_FUNCTION)
#undef HBVOL_GL_FUNCTION
};
