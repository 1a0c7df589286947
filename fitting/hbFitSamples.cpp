#include "fitting/hbFitSamples.h"

#include <atomic>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbMixedBits.h"
#include "volume/hbParallel.h"

hbFitSamples::hbFitSamples(const hbField& source, const hbSparseGrid& grid, int component)
    : source_(source), component_(component), size_(grid.geometry().size) {
  assert(source.geometry().size == size_);
  constexpr std::int64_t kFewest = 64;
  if (count() < kFewest)
    throw hbError(
        fmt::format("fit: expected {} samples at least, some of which can be held out, found {}", kFewest, count()));
  for (int d = 0; d < 3; ++d) {
    const double cells = double(size_[d] - 1);
    for (std::int64_t i = 0; i < size_[d]; ++i) {
      places_[std::size_t(d)].push_back(cells > 0.0 ? double(i) / cells : 0.0);
      // Aligned samples are nodes: the quotient is the lattice's 2^n, and the place exact.
      coordinates_[std::size_t(d)].push_back(cells > 0.0 ? double(i) / (cells / grid.latticeScale()[d]) : 0.0);
    }
  }
  std::atomic<std::int64_t> heldOut{0};
  hb::parallelFor(size_.z, [&](std::int64_t z) {
    std::int64_t here = 0;
    for (std::int64_t i = 0; i < samplesOfPlane(); ++i) here += isHeldOut(z * samplesOfPlane() + i) ? 1 : 0;
    heldOut += here;
  });
  heldOutCount_ = heldOut;
}

void hbFitSamples::plane(std::int64_t z, std::span<float> out) const {
  assert(std::int64_t(out.size()) == samplesOfPlane());
  const std::span at(&places_[2][std::size_t(z)], 1);
  source_.lattice(places_[0], places_[1], at, component_, out.data(), std::size_t(size_.x), out.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i]))
      throw hbError(fmt::format("fit: expected finite samples, found {} at ({},{},{})", out[i],
                                std::int64_t(i) % size_.x, std::int64_t(i) / size_.x, z));
}

bool hbFitSamples::isHeldOut(std::int64_t sample) {
  return hb::mixedBits(std::uint64_t(sample)) % std::uint64_t(kHeldOutOne) == 0;
}

bool hbFitSamples::isOneIn(std::int64_t many, std::int64_t sample) {
  return (hb::mixedBits(std::uint64_t(sample)) / std::uint64_t(kHeldOutOne)) % std::uint64_t(many) == 0;
}
