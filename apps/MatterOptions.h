#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/hbScene.h"

namespace CLI {
class App;
}

namespace app {

/// The options of `render --mode dvr`: what matter looks like, and how it is lit.
struct MatterOptions {
  std::string transfer, transferRange, shading, gradientOpacity;
  std::vector<std::string> lights;
  std::optional<double> unitLength;
  bool preintegrate = false, shade = false, unlit = false;

  void addTo(CLI::App& subcommand);

  /// Puts what was given on top of the scene's. Throws hbError.
  void apply(hbScene& scene) const;

private:
  std::optional<hbTransferFunction> transferFunction(std::optional<hbTransferFunction> known, bool ofLabels) const;
  std::optional<hbShading> shadingOf(std::optional<hbShading> known) const;
};

} // namespace app
