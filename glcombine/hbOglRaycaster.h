#pragma once

#include <memory>

#include "glcombine/hbOglSparseGrid.h"
#include "raycast/hbPlaneCompositor.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbProgress.h"

/// X-ray, MIP and iso-surface pictures of a sparse grid as the paper draws them: for every plane of samples the
/// component grids' textures are blended, the plane is read back, and the ray caster's own sums, maxima and crossings
/// take it (hbPlaneCompositor). Whatever scene.sampling.kind says, sampling is planewise.
class hbOglRaycaster {
public:
  /// Keeps references to `context`, which must be current as hbOglSparseGrid says, to `grid` and to `scene`, which has
  /// a camera. Throws hbError as hbPlaneRays and hbOglSparseGrid do.
  hbOglRaycaster(const hbGlContext& context, const hbCombinationSparseGrid& grid, const hbScene& scene,
                 const hbOglSparseGrid::Options& options);

  /// One frame, with the channels and the metadata of hbRaycaster::render(). Throws hbCancelled.
  hbPicture render(hbProgress& progress = hbProgress::none()) const;

  const hbOglSparseGrid& textures() const { return drawn_; }

private:
  const hbCombinationSparseGrid& grid_;
  const hbScene& scene_;
  hbOglSparseGrid drawn_;
};
