#include "glcombine/hbOglRaycaster.h"

hbOglRaycaster::hbOglRaycaster(const hbGlContext& context, const hbCombinationSparseGrid& grid, const hbScene& scene,
                               const hbOglSparseGrid::Options& options)
    : grid_(grid), scene_(scene), drawn_(context, grid, scene.component, options) {}

hbPicture hbOglRaycaster::render(hbProgress& progress) const {
  const hbPlaneRays rays(grid_, scene_);
  hbPlaneCompositor compositor(rays);
  progress.begin("blending planes", rays.planes(), "planes");
  std::vector<float> values;
  for (int i = 0; i < rays.planes(); ++i) {
    const hbPlaneRays::Plane plane = rays.plane(i);
    drawn_.values({plane.corner, plane.right, plane.down, scene_.width, scene_.height}, values);
    compositor.add(i, values);
    progress.advance(1);
  }
  return compositor.finish();
}
