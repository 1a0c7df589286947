#pragma once

#include <string>

/// A library loaded while the program runs, unloaded never: drivers do not bear it.
class hbSharedLibrary {
public:
  /// Throws hbError naming the library and the system's reason.
  explicit hbSharedLibrary(const std::string& name);

  /// The address of a function; throws hbError where there is none.
  template <class Function>
  Function* function(const char* name) const {
    return reinterpret_cast<Function*>(address(name));
  }

private:
  void* address(const char* name) const;

  std::string name_;
  void* handle_ = nullptr;
};
