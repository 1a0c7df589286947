#pragma once

#include <memory>

#include "glcombine/hbOglSparseGrid.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbProgress.h"

/// X-ray, MIP, iso-surface and DVR pictures of a sparse grid by OpenGL. Whatever scene.sampling.kind says, sampling is
/// planewise, and the pictures are those of hbRaycaster's planewise sampling, up to rounding.
class hbOglRaycaster {
public:
  enum class Form : std::uint8_t {
    blend,    ///< As the paper has it: component grids as 3D textures, blended plane by plane (hbOglSparseGrid).
    fused,    ///< All component grids in one buffer, one shader for the whole picture (hbOglFused).
    seminodal ///< The same of the lines of an hbSemiNodalGrid: fewer terms and less memory.
  };
  struct Options {
    Form form = Form::seminodal;
    /// blend: read every plane back and let hbPlaneCompositor do the rest, as the paper does; else the picture is
    /// read once.
    bool readBack = false;
    /// Bytes of the grid's values on the device at a time.
    std::int64_t memory = std::numeric_limits<std::int64_t>::max();
    hbOglSparseGrid::Options blend{}; ///< But for its memory, which is the above.
  };

  /// Keeps references to `context`, which must be current as hbOglSparseGrid says, and to `grid`. Throws hbError as
  /// hbPlaneRays and the forms do, and where `blend` is to composite on the device what gradients light: its planes
  /// have none.
  hbOglRaycaster(const hbGlContext& context, const hbSparseGrid& grid, const hbScene& scene, const Options& options);
  ~hbOglRaycaster();

  /// Main memory that it takes at its peak, what software keeps for textures included, in bytes.
  static double bytes(const hbSparseGrid& grid, const hbScene& scene, const Options& options);

  /// From now on pictures are seen from there; what is on the device is kept, but DVR's tables where planes lie at
  /// another distance. Throws hbError for a camera that is not valid.
  void look(const hbCamera& camera);

  /// One frame, with the channels and the metadata of hbRaycaster::render(). Throws hbCancelled: `blend` between lots
  /// of planes, the other forms, which are one draw or a few, before or after them.
  hbPicture render(hbProgress& progress = hbProgress::none());

  /// With its camera.
  const hbScene& scene() const;
  /// Of the grid's values; of those that are there all the time.
  std::int64_t textureBytes() const;
  std::int64_t residentBytes() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
