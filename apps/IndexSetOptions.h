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

  /// What they ask for. Throws hbError where the file cannot be read or is no index set, CLI::ValidationError where
  /// options do not go together with one.
  hbSetChoice choice() const;
};

} // namespace app
