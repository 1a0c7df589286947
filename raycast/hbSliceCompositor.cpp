#include "raycast/hbSliceCompositor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volume/hbParallel.h"

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Every part of a band sums into numbers of its own: few and large enough parts that summing them up costs little,
// small enough that the slices of a group stay in the second-level cache.
constexpr std::int64_t kBandRays = 65536;
constexpr int kChunkSlices = 16, kMostChunks = 8;
constexpr int kBandsAtOnce = 4;

} // namespace

hbSliceCompositor::hbSliceCompositor(const hbShearFactorisation& rays, const hbSliceSampler::Source& source,
                                     hbMode mode, float iso, Memory& memory)
    : rays_(rays), sampler_(rays, source), chords_(rays), mode_(mode), iso_(iso), memory_(memory) {
  const std::int64_t count = std::int64_t(rays.u().count) * rays.v().count;
  bands_ = int(std::min<std::int64_t>((count + kBandRays - 1) / kBandRays, rays.v().count));
  chunks_ = std::clamp((rays.slices() - rays.firstSlice() + kChunkSlices - 1) / kChunkSlices, 1, kMostChunks);
}

int hbSliceCompositor::rowOf(int band) const { return int(std::int64_t(rays_.v().count) * band / bands_); }

int hbSliceCompositor::sliceOf(int chunk) const {
  return rays_.firstSlice() + int(std::int64_t(rays_.slices() - rays_.firstSlice()) * chunk / chunks_);
}

std::int64_t hbSliceCompositor::steps() const { return std::int64_t(bands_) * (rays_.slices() - rays_.firstSlice()); }

double hbSliceCompositor::bytes() const {
  const double rays = double(rays_.u().count) * rays_.v().count, band = rays / std::max(1, bands_);
  return 8.0 * rays + band * 8.0 * chunks_ * std::min(kBandsAtOnce, bands_) +
         hb::parallelThreads() * (band * 4.0 * (Scratch::kGroup + 3) + sampler_.bytes());
}

/// The slices at which a ray's chord begins or ends stand for more or less than a slab.
void hbSliceCompositor::weighEnds(int n, const Rectangle& r, const Rectangle& before, const Rectangle& after,
                                  float* out) const {
  for (int j = r.v0; j < r.v1; ++j) {
    // Rays that lie in the cube in both slices beside this one begin and end elsewhere.
    const Rectangle both = before.intersect(after);
    const bool isInner = j >= both.v0 && j < both.v1 && !rays_.isPartlyBehind();
    float* const row = out + std::size_t(rays_.u().count) * std::size_t(j - r.v0);
    const auto weigh = [&](int from, int to) {
      for (int i = from; i < to; ++i) {
        const double weight = chords_.at(i, j).weight(n);
        if (weight != 1.0) row[i - r.u0] = float(weight * double(row[i - r.u0]));
      }
    };
    if (isInner && !both.isEmpty()) {
      weigh(r.u0, std::min(r.u1, both.u0));
      weigh(std::max(r.u0, both.u1), r.u1);
    } else {
      weigh(r.u0, r.u1);
    }
  }
}

void hbSliceCompositor::composite(int band, int chunk, Part& part, hbProgress& progress) const {
  const hbPool<Scratch>::Lease scratch(memory_.scratch);
  scratch->sampler.restart();
  const bool isSum = mode_ == hbMode::xray;
  const float nothing = isSum ? 0.0F : -float(kInfinity);
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * std::size_t(rowOf(band + 1) - rowOf(band));
  const auto place = [&](const Rectangle& r) { return std::size_t(r.u0) + stride * std::size_t(r.v0 - rowOf(band)); };
  const auto fill = [&](std::vector<float>& slice, const Rectangle& r) {
    for (int j = r.v0; j < r.v1; ++j) {
      float* const row = slice.data() + stride * std::size_t(j - rowOf(band));
      std::fill(row + r.u0, row + std::max(r.u0, r.u1), nothing);
    }
  };
  const auto rectangleOf = [&](int n) {
    if (n < rays_.firstSlice() || n >= rays_.slices()) return Rectangle{};
    return sampler_.rectangle(n, rowOf(band), rowOf(band + 1));
  };
  part.values.assign(size, double(nothing));
  part.isEmpty = true;
  for (int begin = sliceOf(chunk); begin < sliceOf(chunk + 1); begin += Scratch::kGroup) {
    const int end = std::min(sliceOf(chunk + 1), begin + Scratch::kGroup);
    Rectangle all;
    std::array<Rectangle, Scratch::kGroup> each;
    for (int n = begin; n < end; ++n) {
      each[std::size_t(n - begin)] = sampler_.rectangle(n, rowOf(band), rowOf(band + 1));
      if (!each[std::size_t(n - begin)].isEmpty()) all.cover(each[std::size_t(n - begin)]);
    }
    progress.advance(end - begin);
    if (all.isEmpty()) continue;
    part.isEmpty = false;
    for (std::size_t k = 0; k < Scratch::kGroup; ++k) {
      std::vector<float>& slice = scratch->slices[k];
      if (slice.size() < size) slice.resize(size);
      const Rectangle& r = each[k];
      const int n = begin + int(k);
      if (n >= end || r.isEmpty()) {
        fill(slice, all);
        continue;
      }
      sampler_.sample(n, r, scratch->sampler, nothing, slice.data() + place(r));
      if (isSum) weighEnds(n, r, rectangleOf(n - 1), rectangleOf(n + 1), slice.data() + place(r));
      fill(slice, {all.u0, all.u1, all.v0, r.v0});
      fill(slice, {all.u0, all.u1, r.v1, all.v1});
      fill(slice, {all.u0, r.u0, r.v0, r.v1});
      fill(slice, {r.u1, all.u1, r.v0, r.v1});
    }
    for (int j = all.v0; j < all.v1; ++j) {
      const std::size_t at = std::size_t(all.u0) + stride * std::size_t(j - rowOf(band));
      const std::array<const float*, Scratch::kGroup> from{
          scratch->slices[0].data() + at, scratch->slices[1].data() + at, scratch->slices[2].data() + at,
          scratch->slices[3].data() + at};
      double* const to = part.values.data() + at;
      const auto count = std::size_t(all.u1 - all.u0);
      if (isSum)
        for (std::size_t i = 0; i < count; ++i)
          to[i] += (double(from[0][i]) + double(from[1][i])) + (double(from[2][i]) + double(from[3][i]));
      else
        for (std::size_t i = 0; i < count; ++i)
          to[i] = std::max(to[i], double(std::max(std::max(from[0][i], from[1][i]), std::max(from[2][i], from[3][i]))));
    }
  }
}

void hbSliceCompositor::findCrossings(int band, int chunk, Part& part, hbProgress& progress) const {
  const hbPool<Scratch>::Lease scratch(memory_.scratch);
  scratch->sampler.restart();
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * std::size_t(rowOf(band + 1) - rowOf(band));
  const auto place = [&](const Rectangle& r) { return std::size_t(r.u0) + stride * std::size_t(r.v0 - rowOf(band)); };
  part.values.assign(size, kInfinity);
  part.isEmpty = false;
  std::vector<float>&before = scratch->slices[0], &now = scratch->slices[1];
  for (std::vector<float>* slice : {&before, &now})
    if (slice->size() < size) slice->resize(size);
  Rectangle rectangleBefore;
  // The last slice of the chunk before is looked at again: a crossing lies between two.
  for (int n = std::max(rays_.firstSlice(), sliceOf(chunk) - 1); n < sliceOf(chunk + 1); ++n) {
    const Rectangle r = sampler_.rectangle(n, rowOf(band), rowOf(band + 1));
    if (!r.isEmpty()) sampler_.sample(n, r, scratch->sampler, float(kNaN), now.data() + place(r));
    const Rectangle both = r.intersect(rectangleBefore);
    for (int j = both.v0; j < both.v1; ++j) {
      const std::size_t first = std::size_t(both.u0) + stride * std::size_t(j - rowOf(band)),
                        end = first + std::size_t(std::max(0, both.u1 - both.u0));
      int crossings = 0; // mostly none in a row, which takes no branches to see
      for (std::size_t i = first; i < end; ++i) crossings |= int(before[i] >= iso_) ^ int(now[i] >= iso_);
      if (crossings == 0) continue;
      for (std::size_t i = first; i < end; ++i) {
        if ((before[i] >= iso_) == (now[i] >= iso_) || part.values[i] < kInfinity || std::isnan(before[i])) continue;
        const double t = (double(iso_) - double(before[i])) / (double(now[i]) - double(before[i]));
        part.values[i] = n - 1 + std::clamp(t, 0.0, 1.0);
      }
    }
    rectangleBefore = r;
    before.swap(now);
    if (n >= sliceOf(chunk)) progress.advance(1);
  }
}

void hbSliceCompositor::merge(int band, std::span<const Part> parts, std::span<double> result) const {
  const auto columns = std::size_t(rays_.u().count);
  const bool isSum = mode_ == hbMode::xray;
  for (const Part& part : parts) {
    if (part.isEmpty) continue;
    for (std::size_t i = 0; i < result.size(); ++i)
      if (mode_ == hbMode::iso)
        result[i] = std::min(result[i], part.values[i]);
      else
        result[i] = isSum ? result[i] + part.values[i] : std::max(result[i], part.values[i]);
  }
  if (mode_ == hbMode::iso) return;
  for (int j = rowOf(band); j < rowOf(band + 1); ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t at = i + columns * std::size_t(j - rowOf(band));
      const hbRayChords::Chord chord = chords_.at(int(i), j);
      if (chord.isEmpty())
        result[at] = kNaN;
      else if (isSum)
        result[at] /= chord.length();
    }
}

std::vector<double> hbSliceCompositor::run(hbProgress& progress) const {
  const auto columns = std::size_t(rays_.u().count);
  const double start = mode_ == hbMode::xray ? 0.0 : mode_ == hbMode::mip ? -kInfinity : kInfinity;
  std::vector<double> result(columns * std::size_t(rays_.v().count), start);
  const hbPool<std::vector<Part>>::Lease parts(memory_.parts);
  for (int band = 0; band < bands_; band += kBandsAtOnce) {
    const int count = std::min(kBandsAtOnce, bands_ - band);
    if (parts->size() < std::size_t(count * chunks_)) parts->resize(std::size_t(count * chunks_));
    hb::parallelFor(std::int64_t(count) * chunks_, [&](std::int64_t task) {
      const int chunk = int(task % chunks_), ofBand = band + int(task / chunks_);
      if (mode_ == hbMode::iso)
        findCrossings(ofBand, chunk, (*parts)[std::size_t(task)], progress);
      else
        composite(ofBand, chunk, (*parts)[std::size_t(task)], progress);
    });
    hb::parallelFor(count, [&](std::int64_t k) {
      const int ofBand = band + int(k);
      merge(ofBand, std::span(*parts).subspan(std::size_t(int(k) * chunks_), std::size_t(chunks_)),
            std::span(result).subspan(columns * std::size_t(rowOf(ofBand)),
                                      columns * std::size_t(rowOf(ofBand + 1) - rowOf(ofBand))));
    });
  }
  return result;
}
