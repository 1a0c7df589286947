#include "bench/views.h"

hbScene bench::view(const hbGeometry& geometry, bool oblique) {
  hbScene scene;
  scene.camera = oblique ? hbCamera::framing(geometry)
                         : hbCamera::framing(geometry, 0.0, 0.0, hbCamera::Projection::orthographic, 1.0,
                                             hbCamera::kFramingMargin);
  return scene;
}

hbTransferFunction bench::transfer(const hbGeometry& geometry, bool everywhere) {
  hbTransferFunction::Definition definition;
  definition.colors = {{0.0, {0.2, 0.3, 0.9}}, {20.0, {0.9, 0.9, 0.8}}, {95.0, {0.9, 0.2, 0.1}}};
  definition.opacities = everywhere ? std::vector<hbTransferFunction::OpacityPoint>{{0.0, 0.002}, {95.0, 0.01}}
                                    : std::vector<hbTransferFunction::OpacityPoint>{{2.0, 0.0}, {40.0, 0.5}};
  definition.unitLength = geometry.spacing.x;
  return hbTransferFunction(definition);
}

void bench::views(benchmark::internal::Benchmark* b) {
  b->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
  b->ArgNames({"size", "oblique"})->ArgsProduct({{129, 257}, {0, 1}});
}
