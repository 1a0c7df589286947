// Values and gradients at random points, on one thread. Items are samples.

#include <vector>

#include <benchmark/benchmark.h>

#include "bench/fields.h"

namespace {

constexpr std::size_t kPoints = 100000;

void values(benchmark::State& state, const hbField& field) {
  const bench::Points points(kPoints);
  std::vector<float> out(kPoints);
  for (auto _ : state) {
    field.values(points.view(), 0, out);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(kPoints));
}

void gradients(benchmark::State& state, const hbField& field) {
  const bench::Points points(kPoints);
  std::vector<float> out(kPoints), dx(kPoints), dy(kPoints), dz(kPoints);
  for (auto _ : state) {
    field.gradients(points.view(), 0, out, {dx, dy, dz});
    benchmark::DoNotOptimize(dx.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(kPoints));
}

void valuesDirect(benchmark::State& state) { values(state, bench::sparseGrid(int(state.range(0)))); }
void valuesCombination(benchmark::State& state) { values(state, bench::combination(int(state.range(0)))); }
void valuesFull(benchmark::State& state) { values(state, bench::volume(int(state.range(0)))); }
void gradientsDirect(benchmark::State& state) { gradients(state, bench::sparseGrid(int(state.range(0)))); }
void gradientsCombination(benchmark::State& state) { gradients(state, bench::combination(int(state.range(0)))); }
void gradientsFull(benchmark::State& state) { gradients(state, bench::volume(int(state.range(0)))); }

void levels(benchmark::internal::Benchmark* b) {
  b->ArgName("level")->DenseRange(5, 11, 2)->Unit(benchmark::kMillisecond);
}
void sizes(benchmark::internal::Benchmark* b) { b->ArgName("size")->Arg(129)->Unit(benchmark::kMillisecond); }

} // namespace

BENCHMARK(valuesDirect)->Name("values/direct")->Apply(levels);
BENCHMARK(valuesCombination)->Name("values/combination")->Apply(levels);
BENCHMARK(valuesFull)->Name("values/full")->Apply(sizes);
BENCHMARK(gradientsDirect)->Name("gradients/direct")->Apply(levels);
BENCHMARK(gradientsCombination)->Name("gradients/combination")->Apply(levels);
BENCHMARK(gradientsFull)->Name("gradients/full")->Apply(sizes);
