#include "apps/IndexSetOptions.h"

#include <charconv>
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "volume/hbError.h"

namespace {

/// "NX,NY,NZ" into the levels; what is wrong otherwise.
std::string parseLevels(const std::string& text, glm::ivec3& levels) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int d = 0; d < 3; ++d) {
    const auto [next, error] = std::from_chars(at, end, levels[d]);
    const bool isLast = d == 2;
    if (error != std::errc() || levels[d] < 1 || levels[d] > hbIndexSet::kMaxLevel ||
        (isLast ? next != end : next == end || *next != ','))
      return fmt::format("expected NX,NY,NZ, levels from 1 to {}, found '{}'", hbIndexSet::kMaxLevel, text);
    at = next + 1;
  }
  return "";
}

} // namespace

void app::IndexSetOptions::addTo(CLI::App& subcommand) {
  CLI::Option* one =
      subcommand.add_option("--level", level, "Level of the grid (default: the one that resolves the longest axis)")
          ->check(CLI::Range(1, hbIndexSet::kMaxLevel));
  subcommand
      .add_option_function<std::string>(
          "--levels-per-axis", [](const std::string&) {},
          "Finest level of each axis instead: an anisotropic grid, for volumes that vary less along some axes")
      ->check([this](const std::string& text) { return parseLevels(text, levelsPerAxis); })
      ->type_name("NX,NY,NZ")
      ->excludes(one);
  subcommand.add_flag("--uncapped", uncapped,
                      "Let axes go finer than the samples, as the paper's grids do (analytic fields always)");
  subcommand
      .add_option("--index-set", set,
                  "regular (default): the sparse grid; full: every subspace, which with --mapping aligned keeps every "
                  "sample; or a file of subspaces, 'lx ly lz' a line (info --index-set writes one)")
      ->type_name("regular|full|FILE");
}

void app::IndexSetOptions::check() const {
  if (isFile() && (level > 0 || levelsPerAxis != glm::ivec3(0) || uncapped))
    throw CLI::ValidationError("--index-set", "expected no --level, --levels-per-axis or --uncapped beside a file");
}

hbSetChoice app::IndexSetOptions::choice() const {
  if (!isFile()) return {level > 0 ? glm::ivec3(level) : levelsPerAxis, set == "full", uncapped, {}};
  if (!std::filesystem::exists(set))
    throw hbError(fmt::format("--index-set: expected regular, full or a file, found '{}'", set));
  return {glm::ivec3(0), false, false, hbIndexSetFile::load(set)};
}
