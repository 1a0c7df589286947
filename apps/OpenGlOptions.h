#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbOglRaycaster.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace app {

/// The options of `render` that belong to the engine opengl.
struct OpenGlOptions {
  std::string context = "auto", form = "seminodal", textures = "r32f", target = "r32f", layout = "exact", order,
              filter = "hardware";
  bool readBack = false, stream = false;
  std::uint64_t textureMemory = 0; ///< Bytes; 0: no limit.

  void addTo(CLI::App& subcommand);

  /// What they ask for. Throws hbError where options do not go together, or any was given for another engine.
  hbOglRaycaster::Options raycaster(bool isOpenGl) const;
  hbGlContext::Kind kind() const;

private:
  std::string firstGiven(const std::vector<CLI::Option*>& options) const;

  std::vector<CLI::Option*> all_, blending_;
};

} // namespace app
