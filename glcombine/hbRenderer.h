#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbOglRaycaster.h"
#include "raycast/hbInput.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbProgress.h"

/// Makes a scene's pictures, one way for each kind of engine: the ray caster, shear-warp, OpenGL.
class hbRenderer {
public:
  struct Options {
    int supersample = 1; ///< lattice: rays a pixel along either axis
    hbGlContext::Kind context = hbGlContext::Kind::automatic;
    hbOglRaycaster::Options openGl{};
    int threads = 0; ///< Of Mesa's software renderer, where LP_NUM_THREADS does not say; 0: one a core.
  };

  /// What there is to say of how pictures are made.
  struct Facts {
    std::string sampling;    ///< "equidistant", "planewise", or "object-aligned".
    std::vector<int> slices; ///< lattice: hbShearWarp::slices()
    int supersample = 0;     ///< lattice
    std::int64_t textureBytes = 0, residentTextureBytes = 0;
    std::string glContext, glVendor, glRenderer, glVersion; ///< "" but with opengl.
  };

  /// `field` is the input's for that engine, or made from it; references to it and to the grid are kept. Of an engine
  /// that needs to be made before that is known, `checkMemory` is told afterwards, of the others before what frames
  /// take beside it, in bytes; it may throw. The thread must be the same for all calls where the engine is opengl.
  /// Throws hbError as hbRaycaster, hbShearWarp and hbOglRaycaster do, and for the magnitude of components by opengl.
  static std::unique_ptr<hbRenderer> create(
      hbEngine engine, const hbInput& input, const hbField& field, const hbScene& scene, const Options& options,
      const std::function<void(double bytes)>& checkMemory = [](double) {});

  virtual ~hbRenderer() = default;
  virtual hbPicture render(hbProgress& progress) = 0;
  /// From now on from there; what does not depend on that is kept. Throws hbError for a camera that is not valid.
  virtual void look(const hbCamera& camera) = 0;
  /// With its camera.
  virtual const hbScene& scene() const = 0;
  virtual Facts facts() const = 0;
};
