#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/OpenGlOptions.h"
#include "apps/Program.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"

namespace app {

/// Makes a scene's pictures, one way for each kind of engine: the ray caster, shear-warp, OpenGL.
class Renderer {
public:
  struct Options {
    std::optional<int> supersample; ///< lattice
    OpenGlOptions openGl;
  };

  /// Throws hbError where options were given that the engine does not know or that do not go together. Looks at
  /// nothing but them.
  static void check(hbEngine engine, const Options& options);

  /// `field` is the input's for that engine, or made from it; references to it and to the grid are kept. Throws
  /// hbError, also where the memory does not suffice for `picture`, a file's name.
  static std::unique_ptr<Renderer> create(hbEngine engine, const hbInput& input, const hbField& field,
                                          const hbScene& scene, const Options& options, const CommonOptions& common,
                                          const std::string& picture);

  virtual ~Renderer() = default;
  virtual hbPicture render() = 0;
  /// From now on from there; what does not depend on that is kept. Throws hbError for a camera that is not valid.
  virtual void look(const hbCamera& camera) = 0;
  /// With its camera.
  virtual const hbScene& scene() const = 0;
  /// Adds to the statistics what is particular to this way.
  virtual void describe(nlohmann::ordered_json& statistics) const = 0;
};

} // namespace app
