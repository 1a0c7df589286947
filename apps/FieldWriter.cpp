#include "apps/FieldWriter.h"

#include <algorithm>
#include <vector>

#include "volume/hbParallel.h"
#include "volume/hbVolumeStream.h"

namespace {

/// One slab after the other: evaluated by all threads, a few rows each, then interleaved, mapped and written as
/// `Sample`s.
template <class Sample>
void writeSamples(const hbField& field, const hbGeometry& geometry, hbVolumeStream& stream, hbProgress& progress) {
  const hbSize3 size = geometry.size;
  const auto xs = geometry.cubeCoordinates(0), ys = geometry.cubeCoordinates(1), zs = geometry.cubeCoordinates(2);
  const hbValueMap map = field.valueMap();
  const auto components = std::size_t(field.components());
  constexpr std::int64_t kRows = 16; // a task's
  const std::int64_t strips = (size.y + kRows - 1) / kRows;
  std::vector<float> values(std::size_t(size.x * size.y));
  std::vector<Sample> slab(values.size() * components);
  progress.begin("writing", size.x * size.y * size.z, "samples");
  for (const double& z : zs) {
    for (std::size_t c = 0; c < components; ++c) {
      hb::parallelFor(strips, [&](std::int64_t strip) {
        const std::int64_t y = strip * kRows, count = std::min(kRows, size.y - y);
        field.lattice(xs, {ys.data() + y, std::size_t(count)}, {&z, 1}, int(c), values.data() + y * size.x,
                      std::size_t(size.x), 0);
        for (std::int64_t i = y * size.x; i < (y + count) * size.x; ++i)
          slab[std::size_t(i) * components + c] = Sample(map.toTrue(values[std::size_t(i)]));
      });
    }
    stream.write(std::as_bytes(std::span(slab)));
    progress.advance(size.x * size.y);
  }
}

} // namespace

void app::writeField(const hbField& field, const hbGeometry& geometry, const std::filesystem::path& path,
                     const CommonOptions& common) {
  const bool wide = !field.valueMap().isIdentity();
  geometry.validate(path.string());
  const hbSize3 size = geometry.size;
  const double sampleBytes = (wide ? sizeof(double) : sizeof(float)) * double(field.components());
  common.checkMemory(double(size.x + size.y + size.z) * sizeof(double) +
                         double(size.x) * double(size.y) * (sizeof(float) + sampleBytes),
                     path.string());
  hbVolumeStream stream(path, geometry, wide ? hbSampleType::float64 : hbSampleType::float32, field.components());
  if (wide)
    writeSamples<double>(field, geometry, stream, progress());
  else
    writeSamples<float>(field, geometry, stream, progress());
  stream.commit();
}
