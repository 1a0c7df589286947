// Values and gradients at a million random points, on one thread. Items are samples. "scalar" is the plain evaluation,
// point by point without vector instructions: what the others are to be compared with.

#include <vector>

#include <benchmark/benchmark.h>

#include "bench/fields.h"

namespace {

constexpr std::size_t kPoints = 1000000;

/// What is evaluated, and where to.
struct Buffers {
  bench::Points points{kPoints};
  std::vector<float> value = std::vector<float>(kPoints), dx = value, dy = value, dz = value;

  static Buffers& get() {
    static Buffers buffers;
    return buffers;
  }
};

template <class Evaluate>
void measure(benchmark::State& state, Evaluate evaluate) {
  for (auto _ : state) {
    evaluate(Buffers::get());
    benchmark::DoNotOptimize(Buffers::get().value.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(kPoints));
}

void values(benchmark::State& state, const hbField& field) {
  measure(state, [&](Buffers& b) { field.values(b.points.view(), 0, b.value); });
}
void gradients(benchmark::State& state, const hbField& field) {
  measure(state, [&](Buffers& b) { field.gradients(b.points.view(), 0, b.value, {b.dx, b.dy, b.dz}); });
}
template <class Field>
void scalarValues(benchmark::State& state, const Field& field) {
  measure(state, [&](Buffers& b) {
    for (std::size_t i = 0; i < kPoints; ++i) b.value[i] = field.calcValue32(b.points.at(i), 0);
  });
}
void scalarGradients(benchmark::State& state, const hbSparseGrid& grid) {
  measure(state, [&](Buffers& b) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      glm::vec3 slopes;
      b.value[i] = grid.calcValue32(b.points.at(i), 0, slopes);
      b.dx[i] = slopes.x;
      b.dy[i] = slopes.y;
      b.dz[i] = slopes.z;
    }
  });
}

int level(const benchmark::State& state) { return int(state.range(0)); }

void valuesDirectScalar(benchmark::State& state) { scalarValues(state, bench::sparseGrid(level(state))); }
void valuesDirect(benchmark::State& state) { values(state, bench::sparseGrid(level(state))); }
void valuesSemiNodal(benchmark::State& state) { values(state, bench::semiNodal(level(state))); }
void valuesCombinationScalar(benchmark::State& state) { scalarValues(state, bench::combination(level(state))); }
void valuesCombination(benchmark::State& state) { values(state, bench::combination(level(state))); }
void valuesFull(benchmark::State& state) { values(state, bench::volume(int(state.range(0)))); }
void gradientsDirectScalar(benchmark::State& state) { scalarGradients(state, bench::sparseGrid(level(state))); }
void gradientsDirect(benchmark::State& state) { gradients(state, bench::sparseGrid(level(state))); }
void gradientsSemiNodal(benchmark::State& state) { gradients(state, bench::semiNodal(level(state))); }
void gradientsCombination(benchmark::State& state) { gradients(state, bench::combination(level(state))); }
void gradientsFull(benchmark::State& state) { gradients(state, bench::volume(int(state.range(0)))); }

void levels(benchmark::internal::Benchmark* b) {
  b->ArgName("level")->DenseRange(5, 11, 2)->Unit(benchmark::kMillisecond);
}
void sizes(benchmark::internal::Benchmark* b) { b->ArgName("size")->Arg(129)->Unit(benchmark::kMillisecond); }

} // namespace

BENCHMARK(valuesDirectScalar)->Name("values/direct-scalar")->Apply(levels);
BENCHMARK(valuesDirect)->Name("values/direct")->Apply(levels);
BENCHMARK(valuesSemiNodal)->Name("values/seminodal")->Apply(levels);
BENCHMARK(valuesCombinationScalar)->Name("values/combination-scalar")->Apply(levels);
BENCHMARK(valuesCombination)->Name("values/combination")->Apply(levels);
BENCHMARK(valuesFull)->Name("values/full")->Apply(sizes);
BENCHMARK(gradientsDirectScalar)->Name("gradients/direct-scalar")->Apply(levels);
BENCHMARK(gradientsDirect)->Name("gradients/direct")->Apply(levels);
BENCHMARK(gradientsSemiNodal)->Name("gradients/seminodal")->Apply(levels);
BENCHMARK(gradientsCombination)->Name("gradients/combination")->Apply(levels);
BENCHMARK(gradientsFull)->Name("gradients/full")->Apply(sizes);
