#pragma once

#include <string>
#include <vector>

#include "apps/Program.h"
#include "apps/SceneOptions.h"
#include "report/hbComparison.h"

namespace app {

/// The options of `compare`.
struct ComparisonOptions {
  InputOptions input;
  SceneOptions scene;
  hbComparison what; ///< All but its scene, once complete() was called.
  std::string out;
  std::vector<std::string> engines, modes, fits;
  bool hardCases = false, noPeers = false;

  /// This must live as long as the subcommand.
  void addTo(CLI::App& subcommand);

  /// Looks at nothing but the options. Throws hbError, and CLI::ValidationError where options do not go together.
  void complete(const CommonOptions& common);

  /// What is looked at, of that volume; defaults are small, as many frames are drawn. Throws hbError.
  hbScene sceneFor(const hbGeometry& geometry) const;
};

} // namespace app
