#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "volume/hbError.h"

/// What the fuzzing targets share. A target is one call of LLVMFuzzerTestOneInput: input from outside may be refused by
/// an hbError and nothing else; any other exception, a sanitizer's report or abort() is a finding.
namespace fuzz {

/// Runs `f`; a refusal must be one that a person can read.
template <class F>
void allowErrors(F&& f) {
  try {
    f();
  } catch (const hbError& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
}

/// Aborts where something that must hold does not.
inline void expect(bool holds) {
  if (!holds) std::abort();
}

} // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
