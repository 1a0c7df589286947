#pragma once

#include <string>

#include <glm/vec3.hpp>

#include "report/hbSetChoice.h"

namespace CLI {
class App;
} // namespace CLI

namespace app {

/// The options of `compress` that say which index set the grid has.
struct IndexSetOptions {
  int level = 0;
  glm::ivec3 levelsPerAxis{0};
  std::string set = "regular"; ///< regular, full, or a file's name
  bool uncapped = false;

  void addTo(CLI::App& subcommand);

  /// Throws CLI::ValidationError where there are options that do not go together with a file.
  void check() const;
  /// What they ask for; reads the file. Throws hbError where it cannot be read or lists no subspaces.
  hbSetChoice choice() const;

private:
  bool isFile() const { return set != "regular" && set != "full"; }
};

} // namespace app
