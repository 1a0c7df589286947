// Whole X-ray pictures of 128 x 128 pixels on all threads, by the wall clock. Items are pictures.

#include <benchmark/benchmark.h>

#include "bench/fields.h"
#include "raycast/hbRaycaster.h"

namespace {

void frame(benchmark::State& state, const hbField& field) {
  hbScene scene;
  scene.width = scene.height = 128;
  scene.sampling.samples = 128; // the same for every engine, whatever its geometry says
  const hbRaycaster raycaster(field, scene);
  for (auto _ : state) benchmark::DoNotOptimize(raycaster.render());
  state.SetItemsProcessed(state.iterations());
}

void frameDirect(benchmark::State& state) { frame(state, bench::sparseGrid(int(state.range(0)))); }
void frameSemiNodal(benchmark::State& state) { frame(state, bench::semiNodal(int(state.range(0)))); }
void frameCombination(benchmark::State& state) { frame(state, bench::combination(int(state.range(0)))); }
void frameFull(benchmark::State& state) { frame(state, bench::volume(int(state.range(0)))); }

void wall(benchmark::internal::Benchmark* b) {
  b->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}

} // namespace

BENCHMARK(frameDirect)->Name("xray-frame/direct")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(frameSemiNodal)->Name("xray-frame/seminodal")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(frameCombination)->Name("xray-frame/combination")->ArgName("level")->Arg(8)->Apply(wall);
BENCHMARK(frameFull)->Name("xray-frame/full")->ArgName("size")->Arg(129)->Apply(wall);
