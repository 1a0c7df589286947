#include "volume/hbVolumeWriter.h"

#include "volume/hbVolumeStream.h"

namespace {

/// The samples of a row as they are, components side by side.
template <class T, bool Swapped>
void copyRow(const hbVolume& volume, std::int64_t y, std::int64_t z, std::span<T> out) {
  const hbVolume::Layout& layout = volume.layout();
  const std::int64_t components = volume.components();
  const std::byte* row = volume.data() + std::int64_t(sizeof(T)) * (y * layout.stride[1] + z * layout.stride[2]);
  for (std::int64_t c = 0; c < components; ++c) {
    const std::byte* at = row + std::int64_t(sizeof(T)) * c * layout.componentStride;
    const std::int64_t step = std::int64_t(sizeof(T)) * layout.stride[0];
    for (std::int64_t x = 0; x < volume.geometry().size.x; ++x, at += step)
      out[std::size_t(x * components + c)] = hb::loadSample<T, Swapped>(at);
  }
}

/// Calls fill(y, z, row) for every row and writes what it put there.
template <class T, class Fill>
void writeRows(const hbVolume& volume, hbVolumeStream& stream, hbProgress& progress, const Fill& fill) {
  const hbSize3 size = volume.geometry().size;
  std::vector<T> row(std::size_t(size.x * volume.components()));
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y) {
      fill(y, z, std::span<T>(row));
      stream.write(std::as_bytes(std::span<const T>(row)));
      progress.advance(1);
    }
}

} // namespace

void hb::writeVolume(const hbVolume& volume, const std::filesystem::path& path, hbProgress& progress) {
  const hbSampleType type = volume.type();
  const bool asStored = volume.slope() == 1.0 && volume.intercept() == 0.0;
  const bool wide = type == hbSampleType::int32 || type == hbSampleType::uint32 || type == hbSampleType::float64;
  const hbSampleType written = asStored ? type : wide ? hbSampleType::float64 : hbSampleType::float32;
  const hbSize3 size = volume.geometry().size;

  hbVolumeStream stream(path, volume.geometry(), written, volume.components(), volume.componentNames());
  progress.begin("writing", size.y * size.z, "rows");
  withSampleType(written, [&](auto tag) {
    using T = decltype(tag);
    if (asStored && volume.layout().byteSwapped) {
      writeRows<T>(volume, stream, progress, [&](auto y, auto z, auto row) { copyRow<T, true>(volume, y, z, row); });
    } else if (asStored) {
      writeRows<T>(volume, stream, progress, [&](auto y, auto z, auto row) { copyRow<T, false>(volume, y, z, row); });
    } else {
      std::vector<double> values(static_cast<std::size_t>(size.x));
      writeRows<T>(volume, stream, progress, [&](auto y, auto z, auto row) {
        for (int c = 0; c < volume.components(); ++c) {
          volume.row(0, y, z, c, values);
          for (std::size_t x = 0; x < values.size(); ++x)
            row[x * std::size_t(volume.components()) + std::size_t(c)] = T(values[x]);
        }
      });
    }
  });
  stream.commit();
}
