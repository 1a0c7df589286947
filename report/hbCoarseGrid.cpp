#include "report/hbCoarseGrid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "volume/coding/hbByteCodec.h"
#include "volume/hbParallel.h"

namespace {

hbGeometry coarser(hbGeometry geometry, std::int64_t longest) {
  const hbSize3 size = geometry.size;
  const double cells = double(std::max({size.x, size.y, size.z}) - 1);
  for (int d = 0; d < 3; ++d) {
    if (size[d] == 1) continue;
    const double share = double(size[d] - 1) / cells;
    geometry.size[d] = std::max<std::int64_t>(2, std::llround(share * double(longest - 1)) + 1);
    geometry.spacing[d] *= double(size[d] - 1) / double(geometry.size[d] - 1);
  }
  return geometry;
}

std::vector<std::byte> pack(std::span<const std::byte> bytes) {
  auto packed = hb::encodeBytes(hbCodec::planesZstd, bytes);
  return packed ? std::move(*packed) : std::vector<std::byte>(bytes.begin(), bytes.end());
}

/// Nodes along the longest axis: larger grids take too long to be tried one after the other.
constexpr std::int64_t kMostTried = 128;

} // namespace

hbVolume hbCoarseGrid::sample(const hbField& source, std::int64_t longest, hbProgress& progress) {
  const hbGeometry geometry = coarser(source.geometry(), longest);
  const hbSize3 size = geometry.size;
  const auto components = std::size_t(source.components());
  const std::vector<double> xs = geometry.cubeCoordinates(0), ys = geometry.cubeCoordinates(1),
                            zs = geometry.cubeCoordinates(2);
  const auto plane = std::size_t(size.x * size.y);
  std::vector<float> samples(std::size_t(geometry.samples()) * components);
  progress.begin("sampling a coarser grid", size.z, "planes");
  hb::parallelFor(size.z, [&](std::int64_t z) {
    std::vector<float> one(plane);
    for (std::size_t c = 0; c < components; ++c) {
      source.lattice(xs, ys, {&zs[std::size_t(z)], 1}, int(c), one.data(), std::size_t(size.x), plane);
      for (std::size_t i = 0; i < plane; ++i) samples[(std::size_t(z) * plane + i) * components + c] = one[i];
    }
    progress.advance(1);
  });
  hbVolume volume = hbVolume::fromSamples(geometry, std::move(samples), source.components());
  volume.setSlopeIntercept(source.valueMap().scale, source.valueMap().offset);
  return volume;
}

hbCoarseGrid hbCoarseGrid::take(const hbField& source, std::int64_t longest, hbProgress& progress) {
  hbVolume volume = sample(source, longest, progress);
  const auto values = std::size_t(volume.geometry().samples() * volume.components());
  std::vector<std::byte> packed = pack({volume.data(), values * sizeof(float)});
  return {std::move(volume), std::move(packed)};
}

hbCoarseGrid hbCoarseGrid::within(const hbField& source, std::uint64_t bytes, hbProgress& progress) {
  const hbSize3 size = source.geometry().size;
  const std::int64_t finest = std::max({size.x, size.y, size.z});
  // From small to large, so that little more is sampled than what fits.
  std::int64_t fits = 2, exceeds = finest + 1;
  hbCoarseGrid best = take(source, fits, progress);
  for (std::int64_t next = std::min<std::int64_t>(3, finest); fits + 1 < exceeds;) {
    hbCoarseGrid grid = take(source, next, progress);
    if (grid.packed.size() <= bytes) {
      fits = next;
      best = std::move(grid);
    } else {
      exceeds = next;
    }
    next = exceeds <= finest ? (fits + exceeds) / 2 : std::min(2 * fits, finest);
  }
  // Sizes whose nodes are samples pack far better than their neighbours, so that a finer one may fit again.
  for (std::int64_t finer = std::min({2 * fits, finest, kMostTried}); finer > fits; --finer) {
    hbCoarseGrid grid = take(source, finer, progress);
    if (grid.packed.size() <= bytes) return grid;
  }
  return best;
}

hbVolume hbCoarseGrid::unpack(const hbVolume& like, const std::vector<std::byte>& packed) {
  const auto count = std::size_t(like.geometry().samples() * like.components());
  std::vector<float> samples(count);
  if (packed.size() == count * sizeof(float)) {
    std::memcpy(samples.data(), packed.data(), packed.size());
  } else {
    bool isOut = false;
    const auto once = [&] { return std::exchange(isOut, true) ? std::span<const std::byte>{} : std::span(packed); };
    const auto bytes = hb::decodeBytes(hbCodec::planesZstd, hb::kCodecVersion, once, count * sizeof(float),
                                       count * sizeof(float), "coarse grid");
    std::memcpy(samples.data(), bytes.data(), bytes.size());
  }
  hbVolume volume = hbVolume::fromSamples(like.geometry(), std::move(samples), like.components());
  volume.setSlopeIntercept(like.slope(), like.intercept());
  return volume;
}
