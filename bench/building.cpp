// Nodal values to surpluses, surpluses to a full lattice.

#include <algorithm>
#include <vector>

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include "bench/fields.h"
#include "sparsegrid/hbHierarchise.h"
#include "sparsegrid/hbLatticeEvaluator.h"

namespace {

/// What the kernel is compared with: the three axes one after the other, line by line, value by value, each found
/// where it lies.
void hierarchisePlainly(const hbIndexSet& set, std::vector<double>& values) {
  for (int axis = 0; axis < 3; ++axis)
    for (const hbSubspace& first : set.subspaces()) {
      if (first.levels[axis] != 0) continue;
      std::vector<const hbSubspace*> byLevel;
      for (glm::ivec3 l = first.levels; set.contains(l); ++l[axis]) byLevel.push_back(&set.subspace(l));
      std::int64_t inner = 1, outer = 1;
      for (int d = 0; d < axis; ++d) inner *= first.nodes[d];
      for (int d = axis + 1; d < 3; ++d) outer *= first.nodes[d];
      for (std::int64_t o = 0; o < outer; ++o)
        for (std::int64_t i = 0; i < inner; ++i) {
          const auto value = [&](std::size_t level, std::int64_t index) -> double& {
            const hbSubspace& subspace = *byLevel[level];
            return values[std::size_t(subspace.offset + (o * subspace.nodes[axis] + index) * inner + i)];
          };
          const auto node = [&](std::size_t level, std::int64_t k) {
            const hbIndexSet::AxisNode n = hbIndexSet::axisNode(false, int(level), k);
            return value(std::size_t(n.level), n.index);
          };
          for (std::size_t level = byLevel.size() - 1; level >= 1; --level)
            for (std::int64_t k = 0; k < byLevel[level]->nodes[axis]; ++k)
              value(level, k) -= 0.5 * (node(level - 1, k) + node(level - 1, k + 1));
        }
    }
}

/// Items are nodes, bytes what three sweeps read and write; by the wall clock.
template <class Transform>
void sweep(benchmark::State& state, Transform transform) {
  const hbSparseGrid& grid = bench::sparseGrid(int(state.range(0)));
  const std::vector<double> nodal = grid.nodalValues(0);
  std::vector<double> values(nodal.size());
  for (auto _ : state) {
    state.PauseTiming();
    std::copy(nodal.begin(), nodal.end(), values.begin()); // again and again in place, the values would overflow
    state.ResumeTiming();
    transform(grid.indexSet(), values);
    benchmark::DoNotOptimize(values.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * std::int64_t(nodal.size()));
  state.SetBytesProcessed(state.iterations() * std::int64_t(nodal.size() * sizeof(double) * 2 * 3));
}

void hierarchise(benchmark::State& state) {
  sweep(state, [](const hbIndexSet& set, std::vector<double>& values) { hb::hierarchise(set, values); });
}
void hierarchiseOnOneThread(benchmark::State& state) {
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  hierarchise(state);
}
void hierarchisePlain(benchmark::State& state) { sweep(state, hierarchisePlainly); }
void dehierarchise(benchmark::State& state) {
  sweep(state, [](const hbIndexSet& set, std::vector<double>& values) { hb::dehierarchise(set, values); });
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

/// One plane with its three slopes, places between nodes; on one thread.
void latticeGradient(benchmark::State& state) {
  using Quantity = hbLatticeEvaluator::Quantity;
  const hbLatticeEvaluator evaluator(bench::sparseGrid(int(state.range(0))), 0);
  const auto size = std::size_t(state.range(1));
  std::vector<double> places;
  for (std::size_t i = 0; i < size; ++i) places.push_back((double(i) + 0.37) / double(size));
  std::vector<float> out(size * size);
  hbLatticeWorkspace workspace;
  for (auto _ : state)
    for (const Quantity q : {Quantity::value, Quantity::slopeFast, Quantity::slopeRow, Quantity::slopePlane}) {
      evaluator.plane(evaluator.plan(places, places, q), 0.4, workspace, out.data(), size);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
  state.SetItemsProcessed(state.iterations() * std::int64_t(out.size()));
}

void levels(benchmark::internal::Benchmark* b) {
  b->ArgName("level")->Arg(9)->Arg(11)->UseRealTime()->Unit(benchmark::kMillisecond);
}

} // namespace

BENCHMARK(hierarchisePlain)->Name("hierarchise/strided-scalar")->Apply(levels);
BENCHMARK(hierarchiseOnOneThread)->Name("hierarchise/one-thread")->Apply(levels);
BENCHMARK(hierarchise)->Name("hierarchise/all-threads")->Apply(levels);
BENCHMARK(dehierarchise)->Name("dehierarchise/all-threads")->Apply(levels);
BENCHMARK(latticeGradient)->Name("lattice-gradient")->ArgNames({"level", "size"})->Args({11, 200});
BENCHMARK(lattice)->ArgNames({"level", "size"})->Args({8, 129})->Unit(benchmark::kMillisecond);
