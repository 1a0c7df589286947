#include "raycast/hbFullGrid.h"

#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include <sys/mman.h>

#include "raycast/hbPool.h"
#include "sparsegrid/hbLatticeEvaluator.h"
#include "volume/hbParallel.h"

namespace {

/// Memory in large pages where the system has them: touching it for the first time otherwise takes longer than the
/// evaluation. Not cleared, so that the threads that fill it do that.
std::shared_ptr<float> freshMemory(std::size_t bytes) {
  constexpr std::size_t kLargePage = std::size_t{2} << 20;
  const std::size_t whole = (bytes + kLargePage - 1) / kLargePage * kLargePage;
  void* const memory = std::aligned_alloc(kLargePage, whole);
  if (memory == nullptr) throw std::bad_alloc();
  ::madvise(memory, whole, MADV_HUGEPAGE); // an advice: whether it is taken does not matter
  return {static_cast<float*>(memory), [](float* all) { std::free(all); }};
}

} // namespace

double hb::fullGridBytes(const hbSparseGrid& grid) {
  return double(sizeof(float)) * double(grid.geometry().samples()) * grid.components();
}

hbVolume hb::extractFullGrid(const hbSparseGrid& grid, hbProgress& progress) {
  const hbGeometry& geometry = grid.geometry();
  const std::int64_t samples = geometry.samples();
  const auto row = std::size_t(geometry.size.x), slice = row * std::size_t(geometry.size.y);
  const std::shared_ptr<float> values =
      freshMemory(std::size_t(samples) * std::size_t(grid.components()) * sizeof(float));
  const std::vector<double> xs = geometry.cubeCoordinates(0), ys = geometry.cubeCoordinates(1),
                            zs = geometry.cubeCoordinates(2);
  hbPool<hbLatticeWorkspace> workspaces;
  progress.begin("extracting the full grid", geometry.size.z * grid.components(), "slices");
  for (int component = 0; component < grid.components(); ++component) {
    const hbLatticeEvaluator evaluator(grid, component);
    const hbLatticePlan plan = evaluator.plan(xs, ys);
    float* const first = values.get() + std::size_t(samples) * std::size_t(component);
    hb::parallelFor(geometry.size.z, [&](std::int64_t z) {
      const hbPool<hbLatticeWorkspace>::Lease workspace(workspaces);
      evaluator.plane(plan, zs[std::size_t(z)], *workspace, first + slice * std::size_t(z), row, true);
      progress.advance(1);
    });
  }
  hbVolume::Layout layout = hbVolume::Layout::packed(geometry.size, 1);
  layout.componentStride = samples;
  hbVolume volume(geometry, hbSampleType::float32, grid.components(),
                  {values, reinterpret_cast<const std::byte*>(values.get())}, layout);
  volume.setSlopeIntercept(grid.valueMap().scale, grid.valueMap().offset);
  return volume;
}
