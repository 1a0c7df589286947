// Nodal values to surpluses, surpluses to a full lattice.

#include <vector>

#include <benchmark/benchmark.h>

#include "bench/fields.h"
#include "sparsegrid/hbHierarchise.h"

namespace {

/// Items are nodes; on all threads, so by the wall clock.
void hierarchise(benchmark::State& state) {
  const hbSparseGrid& grid = bench::sparseGrid(int(state.range(0)));
  const std::vector<double> nodal = grid.nodalValues(0);
  for (auto _ : state) {
    state.PauseTiming();
    std::vector<double> values = nodal; // again and again in place, the values would overflow
    state.ResumeTiming();
    hb::hierarchise(grid.indexSet(), values);
    benchmark::DoNotOptimize(values.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(nodal.size()));
}

/// Items are samples; one call, on one thread.
void lattice(benchmark::State& state) {
  const hbSparseGrid& grid = bench::sparseGrid(int(state.range(0)));
  const auto size = std::size_t(state.range(1));
  std::vector<double> nodes;
  for (std::size_t i = 0; i < size; ++i) nodes.push_back(double(i) / double(size - 1));
  std::vector<float> out(size * size * size);
  for (auto _ : state) {
    grid.lattice(nodes, nodes, nodes, 0, out.data(), size, size * size);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(out.size()));
}

} // namespace

BENCHMARK(hierarchise)->ArgName("level")->Arg(9)->Arg(11)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(lattice)->ArgNames({"level", "size"})->Args({8, 129})->Unit(benchmark::kMillisecond);
