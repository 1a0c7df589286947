#include "volume/hbInstructionSet.h"

#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/targets.h>

#include "volume/hbError.h"

namespace {

/// Those this file was compiled for: all files with kernels are compiled alike.
std::vector<std::int64_t> available() { return hwy::SupportedAndGeneratedTargets(); }

/// The choice of useInstructionSet(), 0 for the best one.
std::int64_t chosen = 0;

} // namespace

std::vector<std::string> hb::instructionSets() {
  hwy::SetSupportedTargetsForTest(0); // every one again
  std::vector<std::string> names;
  for (const std::int64_t target : available()) names.emplace_back(hwy::TargetName(target));
  hwy::SetSupportedTargetsForTest(chosen);
  return names;
}

std::string hb::instructionSet() { return hwy::TargetName(available().front()); }

void hb::useInstructionSet(std::string_view name) {
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t wanted = 0;
  for (const std::int64_t target : available())
    if (name == hwy::TargetName(target)) wanted = target;
  if (wanted == 0 && !name.empty()) {
    hwy::SetSupportedTargetsForTest(chosen);
    throw hbError(
        fmt::format("instruction set: expected one of {}, found '{}'", fmt::join(instructionSets(), ", "), name));
  }
  chosen = wanted;
  hwy::SetSupportedTargetsForTest(chosen);
}
