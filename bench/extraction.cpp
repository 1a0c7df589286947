// Sparse grids to full lattices in memory that was touched before, beside memset of the same bytes cut into the same
// parts. Iterations take turns; the time is the extraction's, counters say the rest: medians, and the least and the
// greatest ratio of one turn. memset is measured with zeros, which some processors write at twice the speed of anything
// else, and with another byte: what no extraction can beat.

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include "bench/fields.h"
#include "volume/hbParallel.h"

namespace {

constexpr std::int64_t kPlanes = 16; // a part

template <class Work>
double secondsOf(Work work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Arguments: level (the lattice has all its nodes), threads.
void extraction(benchmark::State& state) {
  const hbSparseGrid& grid = bench::sparseGrid(int(state.range(0)));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                          std::size_t(state.range(1)));
  const std::int64_t size = (std::int64_t{1} << state.range(0)) + 1, plane = size * size;
  std::vector<double> nodes;
  for (std::int64_t i = 0; i < size; ++i) nodes.push_back(double(i) / double(size - 1));
  const auto out = std::make_unique_for_overwrite<float[]>(std::size_t(size * plane));
  const auto inParts = [&](auto part) {
    hb::parallelFor((size + kPlanes - 1) / kPlanes, [&](std::int64_t i) {
      part(i * kPlanes, std::min(kPlanes, size - i * kPlanes), out.get() + i * kPlanes * plane);
    });
  };
  const auto fill = [&](int byte) {
    inParts([&](std::int64_t, std::int64_t count, float* to) {
      std::memset(to, byte, std::size_t(count * plane) * sizeof(float));
      benchmark::ClobberMemory();
    });
  };
  fill(1);
  std::vector<double> extractions, memsets, others, ratios;
  for (auto _ : state) {
    others.push_back(secondsOf([&] { fill(1); }));
    memsets.push_back(secondsOf([&] { fill(0); }));
    extractions.push_back(secondsOf([&] {
      inParts([&](std::int64_t z, std::int64_t count, float* to) {
        grid.lattice(nodes, nodes, {nodes.data() + z, std::size_t(count)}, 0, to, std::size_t(size),
                     std::size_t(plane));
      });
    }));
    ratios.push_back(extractions.back() / memsets.back());
    state.SetIterationTime(extractions.back());
  }
  state.SetItemsProcessed(state.iterations() * size * plane);
  state.counters["median_ms"] = 1e3 * median(extractions);
  state.counters["memset_ms"] = 1e3 * median(memsets);
  state.counters["over_memset"] = median(extractions) / median(memsets);
  state.counters["over_memset_of_ones"] = median(extractions) / median(others);
  state.counters["least"] = *std::min_element(ratios.begin(), ratios.end());
  state.counters["greatest"] = *std::max_element(ratios.begin(), ratios.end());
}

} // namespace

BENCHMARK(extraction)
    ->ArgNames({"level", "threads"})
    ->ArgsProduct({{9, 10}, {2, 1}})
    ->Iterations(9)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
