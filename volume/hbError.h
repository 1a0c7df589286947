#pragma once

#include <stdexcept>
#include <string>

/// Bad input or a failing environment: the one exception type of the library.
///
/// The text is one line that names the file (or option), the place, what was expected and what was found; the program
/// prints it after "hbvol: error: ". A caller's own bug is an assertion, ordinary absence a std::optional.
class hbError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Thrown by long work whose hbProgress was cancelled. Nothing that the work wrote remains, unless the text says so.
class hbCancelled : public hbError {
public:
  hbCancelled() : hbError("interrupted; nothing was written") {}
  explicit hbCancelled(const std::string& text) : hbError(text) {}
};
