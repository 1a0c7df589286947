// Pictures of a plain volume by the software ray caster. Items are nominal samples (bench/views.h) a second of process
// CPU time; bench/peers measures others with the same views, steps and transfer functions.

#include <benchmark/benchmark.h>

#include "bench/fields.h"
#include "bench/views.h"
#include "raycast/hbNominalSamples.h"
#include "raycast/hbRaycaster.h"

namespace {

/// Arguments: samples an axis, whether oblique.
void picture(benchmark::State& state, hbMode mode, bool everywhere = false, bool shaded = false, bool slabs = false) {
  const hbVolumeField& field = bench::volume(int(state.range(0)));
  hbScene scene = bench::view(field.geometry(), state.range(1) != 0);
  scene.mode = mode;
  scene.transfer = bench::transfer(field.geometry(), everywhere);
  if (shaded) scene.shading.emplace();
  scene.preintegrated = slabs;
  const hbRaycaster raycaster(field, scene);
  for (auto _ : state) benchmark::DoNotOptimize(raycaster.render());
  state.SetItemsProcessed(std::int64_t(double(state.iterations()) * hb::nominalSamples(field.geometry(), scene)));
}

void xray(benchmark::State& state) { picture(state, hbMode::xray); }
void mip(benchmark::State& state) { picture(state, hbMode::mip); }
void composite(benchmark::State& state) { picture(state, hbMode::dvr); }
void compositeEverywhere(benchmark::State& state) { picture(state, hbMode::dvr, true); }
void compositeShaded(benchmark::State& state) { picture(state, hbMode::dvr, false, true); }
void compositeSlabs(benchmark::State& state) { picture(state, hbMode::dvr, false, false, true); }

} // namespace

BENCHMARK(xray)->Name("raycast/xray")->Apply(bench::views);
BENCHMARK(mip)->Name("raycast/mip")->Apply(bench::views);
BENCHMARK(composite)->Name("raycast/composite")->Apply(bench::views);
BENCHMARK(compositeEverywhere)->Name("raycast/composite-everywhere")->Apply(bench::views);
BENCHMARK(compositeShaded)->Name("raycast/composite-shaded")->Apply(bench::views);
BENCHMARK(compositeSlabs)->Name("raycast/composite-preintegrated")->Apply(bench::views);
