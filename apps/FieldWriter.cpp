#include "apps/FieldWriter.h"

#include <algorithm>
#include <span>
#include <type_traits>
#include <vector>

#include "volume/hbLatticeParts.h"
#include "volume/hbParallel.h"
#include "volume/hbVolumeStream.h"

namespace {

constexpr std::int64_t kSlabBytes = 24 * (std::int64_t{1} << 20);

/// A part's values as samples: mapped, components side by side.
template <class Sample>
void evaluate(const hbField& field, const hbLatticeParts& parts, const hbLatticeParts::Part& part, Sample* out) {
  const int components = field.components();
  if constexpr (std::is_same_v<Sample, float>)
    if (components == 1) return parts.evaluate(field, 0, part, out);
  const hbValueMap map = field.valueMap();
  std::vector<float> values(std::size_t(parts.samples(part)));
  for (int c = 0; c < components; ++c) {
    parts.evaluate(field, c, part, values.data());
    for (std::size_t i = 0; i < values.size(); ++i)
      out[i * std::size_t(components) + std::size_t(c)] = Sample(map.toTrue(values[i]));
  }
}

/// Slab after slab of as many parts as `samplesPerSlab` hold, at least one.
template <class Sample>
void write(const hbField& field, const hbLatticeParts& parts, std::int64_t samplesPerSlab, hbVolumeStream& stream,
           hbProgress& progress) {
  const std::int64_t count = parts.count(), components = field.components(),
                     perSlab = std::max<std::int64_t>(1, samplesPerSlab / parts.samples(parts.part(0)));
  std::vector<Sample> slab;
  progress.begin("writing", parts.size().x * parts.size().y * parts.size().z, "samples");
  for (std::int64_t first = 0; first < count; first += perSlab) {
    const std::int64_t own = std::min(perSlab, count - first);
    const hbLatticeParts::Part last = parts.part(first + own - 1);
    const std::int64_t begin = parts.samplesBefore(parts.part(first));
    slab.resize(std::size_t((parts.samplesBefore(last) + parts.samples(last) - begin) * components));
    hb::parallelFor(own, [&](std::int64_t index) {
      const hbLatticeParts::Part part = parts.part(first + index);
      evaluate(field, parts, part, slab.data() + (parts.samplesBefore(part) - begin) * components);
      progress.advance(parts.samples(part));
    });
    stream.write(std::as_bytes(std::span(slab)));
  }
}

} // namespace

std::uint64_t app::writeField(const hbField& field, const hbSubLattice& lattice, const std::filesystem::path& path,
                              const CommonOptions& common) {
  const hbGeometry geometry = lattice.geometry();
  geometry.validate(path.string());
  const bool wide = !field.valueMap().isIdentity();
  const std::int64_t components = field.components(),
                     sampleBytes = std::int64_t(wide ? sizeof(double) : sizeof(float)) * components;
  const hbSize3 size = geometry.size;
  const std::int64_t perSlab = std::max(size.x, kSlabBytes / sampleBytes);
  const double slab = std::min(double(geometry.samples()), double(perSlab));
  common.checkMemory(double(size.x + size.y + size.z) * sizeof(double) + slab * double(sampleBytes) +
                         (wide || components > 1 ? slab * sizeof(float) : 0.0),
                     path.string());
  const hbLatticeParts parts(lattice.cubeCoordinates(0), lattice.cubeCoordinates(1), lattice.cubeCoordinates(2),
                             std::min(perSlab, hbLatticeParts::kMostSamples));
  hbVolumeStream stream(path, geometry, wide ? hbSampleType::float64 : hbSampleType::float32, field.components());
  if (wide)
    write<double>(field, parts, perSlab, stream, progress());
  else
    write<float>(field, parts, perSlab, stream, progress());
  stream.commit();
  return stream.bytes();
}
