#pragma once

#include <cstdint>
#include <string>

/// What measurements were made on.
struct hbMachine {
  std::string processor; ///< The model's name; "unknown" where the system does not tell.
  int cores = 0;         ///< That the process may use.
  std::uint64_t memoryBytes = 0;
  std::string system;         ///< Kernel and release.
  std::string compiler;       ///< Of this library, and its version.
  std::string instructionSet; ///< That the kernels use, see hb::instructionSet().

  /// This one, now.
  static hbMachine current();
};
