#pragma once

#include <array>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbSharedLibrary.h"

/// Mesa's software renderer, which draws into memory of the program (Mesa up to 25.0).
class hbOsMesaContext final : public hbGlContext {
public:
  /// Throws hbError where the library is missing or refuses.
  hbOsMesaContext();
  ~hbOsMesaContext() override;

  void makeCurrent() override;
  void release() override;
  std::string_view kind() const override { return "osmesa"; }

private:
  hbSharedLibrary library_{"libOSMesa.so.8"};
  void* context_ = nullptr;
  std::array<unsigned char, 4 * 4 * 4> buffer_{}; ///< OSMesa wants one; nothing is drawn into it.
};
