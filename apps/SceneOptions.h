#pragma once

#include <optional>
#include <string>

#include "apps/MatterOptions.h"
#include "scene/hbScene.h"

namespace CLI {
class App;
}

namespace app {

/// The options of `render` that say what is looked at and how.
struct SceneOptions {
  std::string file, mode, size, camera, projection, window, colormap, component, sampling, background, clip, slice;
  std::optional<double> azimuth, elevation, zoom, iso;
  MatterOptions matter;
  bool labels = false;
  int samples = 0;

  void addTo(CLI::App& subcommand);

  /// The scene file, if any, with the options on top; the camera is chosen, an iso-value perhaps not. Throws hbError.
  hbScene scene(const hbGeometry& geometry) const;

private:
  /// Gives the scene the plane that --slice asks for.
  void cut(hbScene& scene, const hbGeometry& geometry) const;
  /// Gives the scene a camera: --camera, or a framing by the angles, or its own; then the zoom.
  void place(hbScene& scene, const hbGeometry& geometry) const;
};

} // namespace app
