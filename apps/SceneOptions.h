#pragma once

#include <optional>
#include <string>

#include "scene/hbScene.h"

namespace CLI {
class App;
}

namespace app {

/// The options of `render` that say what is looked at and how.
struct SceneOptions {
  std::string file, mode, size, camera, projection, window, colormap, component, sampling, transfer, transferRange,
      background;
  std::optional<double> azimuth, elevation, zoom, iso, unitLength;
  bool preintegrate = false;
  int samples = 0;

  void addTo(CLI::App& subcommand);

  /// The scene file, if any, with the options on top; the camera is chosen, an iso-value perhaps not. Throws hbError.
  hbScene scene(const hbGeometry& geometry) const;

private:
  /// The transfer function that the options ask for, on top of the scene's.
  std::optional<hbTransferFunction> transferFunction(std::optional<hbTransferFunction> known) const;
  /// Gives the scene a camera: --camera, or a framing by the angles, or its own; then the zoom.
  void place(hbScene& scene, const hbGeometry& geometry) const;
};

} // namespace app
