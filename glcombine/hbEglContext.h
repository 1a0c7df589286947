#pragma once

#include "glcombine/hbGlContext.h"
#include "glcombine/hbSharedLibrary.h"

/// A context by EGL without a surface: on the first graphics processor found, otherwise on Mesa's surfaceless platform.
class hbEglContext final : public hbGlContext {
public:
  /// Throws hbError where the library is missing or no device gives a context.
  hbEglContext();
  ~hbEglContext() override;

  void makeCurrent() override;
  void release() override;
  std::string_view kind() const override { return "egl"; }

private:
  /// EGL's own types are pointers to what nobody knows.
  bool open(void* display);

  hbSharedLibrary library_{"libEGL.so.1"};
  void* display_ = nullptr;
  void* context_ = nullptr;
};
