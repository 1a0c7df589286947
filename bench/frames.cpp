// Whole pictures on all threads, by the wall clock. Items are pictures.

#include <string>

#include <benchmark/benchmark.h>

#include "bench/fields.h"
#include "raycast/hbRaycaster.h"
#include "raycast/hbShearWarp.h"

namespace {

/// X-rays of 128 x 128 pixels by ray casting.
void xray(benchmark::State& state, const hbField& field) {
  hbScene scene;
  scene.width = scene.height = 128;
  scene.sampling.samples = 128; // the same for every engine, whatever its geometry says
  const hbRaycaster raycaster(field, scene);
  for (auto _ : state) benchmark::DoNotOptimize(raycaster.render());
  state.SetItemsProcessed(state.iterations());
}

void xrayDirect(benchmark::State& state) { xray(state, bench::sparseGrid(int(state.range(0)))); }
void xraySemiNodal(benchmark::State& state) { xray(state, bench::semiNodal(int(state.range(0)))); }
void xrayCombination(benchmark::State& state) { xray(state, bench::combination(int(state.range(0)))); }
void xrayFull(benchmark::State& state) { xray(state, bench::volume(int(state.range(0)))); }

/// Arguments: level, mode, degrees from the y axis, whether in perspective. 200 x 200 pixels, 128 samples a ray.
hbScene sceneOf(const benchmark::State& state, const hbGeometry& geometry) {
  hbScene scene;
  scene.mode = hbMode(state.range(1));
  scene.width = scene.height = 200;
  scene.sampling.samples = 128;
  scene.isoValue = 10.0;
  scene.camera =
      hbCamera::framing(geometry, double(state.range(2)), 0.0,
                        state.range(3) != 0 ? hbCamera::Projection::perspective : hbCamera::Projection::orthographic);
  return scene;
}

template <class Renderer>
void frame(benchmark::State& state, const Renderer& renderer) {
  benchmark::DoNotOptimize(renderer.render());
  for (auto _ : state) benchmark::DoNotOptimize(renderer.render());
  state.SetItemsProcessed(state.iterations());
  state.SetLabel(std::string(hb::modeName(renderer.scene().mode)));
}

void frameLattice(benchmark::State& state) {
  const hbSparseGrid& grid = bench::sparseGrid(int(state.range(0)));
  frame(state, hbShearWarp(grid, sceneOf(state, grid.geometry()), {}));
}
void frameSemiNodal(benchmark::State& state) {
  const hbSemiNodalGrid& grid = bench::semiNodal(int(state.range(0)));
  frame(state, hbRaycaster(grid, sceneOf(state, grid.geometry())));
}

void wall(benchmark::internal::Benchmark* b) {
  b->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}
void views(benchmark::internal::Benchmark* b) {
  wall(b);
  b->ArgNames({"level", "mode", "degrees", "perspective"});
  b->ArgsProduct({{11, 12}, {int(hbMode::xray), int(hbMode::mip), int(hbMode::iso)}, {0, 35}, {0, 1}});
}

} // namespace

BENCHMARK(xrayDirect)->Name("xray-frame/direct")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(xraySemiNodal)->Name("xray-frame/seminodal")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(xrayCombination)->Name("xray-frame/combination")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(xrayFull)->Name("xray-frame/full")->ArgName("size")->Arg(129)->Apply(wall);
BENCHMARK(frameLattice)->Name("frame/lattice")->Apply(views);
BENCHMARK(frameSemiNodal)->Name("frame/seminodal")->Apply(views);
