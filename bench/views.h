#pragma once

#include <benchmark/benchmark.h>

#include "scene/hbScene.h"
#include "volume/hbGeometry.h"

/// How the benchmarks of ray casting, hbvol's and its peers', look at a cube.
namespace bench {

/// 512 x 512 pixels, a sample a voxel. `oblique`: in perspective from the default angle; otherwise parallel along +y,
/// with the volume's face just filling the picture.
hbScene view(const hbGeometry& geometry, bool oblique);

/// The transfer function of the composited pictures, for values of the hydrogen orbital (0 to 95): nothing is seen
/// below 2, from 40 on half of the light goes through a voxel. With `everywhere` all values are seen, and faintly, so
/// that no ray ends early.
hbTransferFunction transfer(const hbGeometry& geometry, bool everywhere);

/// The arguments of a benchmark of pictures, samples an axis and whether oblique, and its unit: process CPU time.
void views(benchmark::internal::Benchmark* b);

} // namespace bench
