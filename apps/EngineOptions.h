#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/OpenGlOptions.h"
#include "glcombine/hbRenderer.h"

namespace CLI {
class App;
}

namespace app {

struct CommonOptions;

/// The options of `render` that say which engine draws, and how it does.
struct EngineOptions {
  std::string name = "auto";
  std::optional<int> supersample;
  OpenGlOptions openGl;

  void addTo(CLI::App& subcommand);

  /// The engine. Throws hbError where options were given that it does not know or that do not go together. Looks at
  /// nothing but them.
  hbEngine engine() const;
  hbRenderer::Options renderer(const CommonOptions& common) const;
  /// Adds to the statistics what is particular to the engine.
  void describe(const hbRenderer::Facts& facts, nlohmann::ordered_json& statistics) const;
};

} // namespace app
