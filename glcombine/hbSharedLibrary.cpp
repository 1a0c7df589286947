#include "glcombine/hbSharedLibrary.h"

#include <dlfcn.h>

#include <fmt/format.h>

#include "volume/hbError.h"

hbSharedLibrary::hbSharedLibrary(const std::string& name) : name_(name) {
  // Local: OSMesa has OpenGL's functions under their own names, which nobody else may find.
  handle_ = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle_) {
    const char* reason = ::dlerror();
    throw hbError(fmt::format("expected the library {}, which cannot be loaded ({})", name, reason ? reason : "?"));
  }
}

void* hbSharedLibrary::address(const char* name) const {
  void* found = ::dlsym(handle_, name);
  if (!found) throw hbError(fmt::format("{}: expected the function {}, found none", name_, name));
  return found;
}
