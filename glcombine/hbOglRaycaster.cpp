#include "glcombine/hbOglRaycaster.h"

hbOglRaycaster::hbOglRaycaster(const hbGlContext& context, const hbCombinationSparseGrid& grid, const hbScene& scene,
                               const hbOglSparseGrid::Options& options)
    : grid_(grid), scene_(scene), drawn_(context, grid, scene.component, options) {}

hbPicture hbOglRaycaster::render(hbProgress& progress) const {
  hbPlaneCompositor compositor(grid_, scene_);
  progress.begin("blending planes", compositor.planes(), "planes");
  std::vector<float> values;
  for (int i = 0; i < compositor.planes(); ++i) {
    const hbPlaneCompositor::Plane plane = compositor.plane(i);
    drawn_.values({plane.corner, plane.right, plane.down, scene_.width, scene_.height}, values);
    compositor.add(i, values);
    progress.advance(1);
  }
  return compositor.finish();
}
