#include "report/hbValueDifference.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

constexpr std::int64_t kPiece = 4096; // samples at a time, so that the buffer stays small for long rows

/// `buffer` holds two pieces.
hbErrorStatistics rowDifference(const hbVolume& a, const hbVolume& b, std::int64_t row, int component,
                                std::span<double> buffer) {
  const hbSize3& size = a.geometry().size;
  hbErrorStatistics sum;
  for (std::int64_t x = 0; x < size.x; x += kPiece) {
    const std::size_t count = std::size_t(std::min(kPiece, size.x - x));
    const auto reference = buffer.first(count), values = buffer.subspan(count, count);
    a.row(x, row % size.y, row / size.y, component, reference);
    b.row(x, row % size.y, row / size.y, component, values);
    for (std::size_t i = 0; i < count; ++i) sum.add(reference[i], values[i]);
  }
  return sum;
}

} // namespace

hbErrorStatistics hb::volumeDifference(const hbVolume& a, const hbVolume& b, int component, hbProgress& progress) {
  const hbSize3 &size = a.geometry().size, &other = b.geometry().size;
  if (size != other)
    throw hbError(fmt::format("difference: expected volumes of equal size, found {} x {} x {} and {} x {} x {}", size.x,
                              size.y, size.z, other.x, other.y, other.z));
  if (component < 0 || component >= std::min(a.components(), b.components()))
    throw hbError(fmt::format("difference: expected a component that both volumes have, found {} of {} and {}",
                              component, a.components(), b.components()));

  // Slabs of whole rows: their number depends on the volume only, so the order of the sums does too.
  constexpr std::int64_t kMaxSlabs = 1024;
  const std::int64_t rows = size.y * size.z, slabs = std::min(rows, kMaxSlabs);
  // The first of slab s; not rows * s / slabs, which overflows for very many rows.
  const auto firstRow = [&](std::int64_t s) { return rows / slabs * s + std::min(s, rows % slabs); };
  std::vector<hbErrorStatistics> parts(std::size_t(slabs), hbErrorStatistics{});
  progress.begin("comparing", rows, "rows");
  hb::parallelFor(slabs, [&](std::int64_t s) {
    std::vector<double> buffer(std::size_t(2 * std::min(kPiece, size.x)));
    for (std::int64_t row = firstRow(s); row < firstRow(s + 1); ++row)
      parts[std::size_t(s)].merge(rowDifference(a, b, row, component, buffer));
    progress.advance(firstRow(s + 1) - firstRow(s));
  });
  hbErrorStatistics sum;
  for (const hbErrorStatistics& part : parts) sum.merge(part);
  return sum;
}
