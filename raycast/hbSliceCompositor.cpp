#include "raycast/hbSliceCompositor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volume/hbParallel.h"

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

} // namespace

hbSliceCompositor::hbSliceCompositor(const hbShearFactorisation& rays, const hbSliceSampler::Source& source,
                                     hbMode mode, float iso, Memory& memory)
    : rays_(rays), sampler_(rays, source), chords_(rays), tasks_(rays), mode_(mode), iso_(iso), memory_(memory) {}

std::int64_t hbSliceCompositor::steps() const { return tasks_.steps(); }

double hbSliceCompositor::bytes() const {
  return 8.0 * rays_.u().count * rays_.v().count + 8.0 * tasks_.raysAtOnce() +
         hb::parallelThreads() * (tasks_.raysAPiece() * 4.0 * (Scratch::kGroup + 3) + sampler_.bytes());
}

/// The slices at which a ray's chord begins or ends stand for more or less than a slab.
void hbSliceCompositor::weighEnds(int n, const Rectangle& r, float* out) const {
  const Rectangle inner = sampler_.inner(n, r);
  for (int j = r.v0; j < r.v1; ++j) {
    float* const row = out + std::size_t(rays_.u().count) * std::size_t(j - r.v0);
    const auto weigh = [&](int from, int to) {
      for (int i = from; i < to; ++i) {
        const double weight = chords_.at(i, j).weight(n);
        if (weight != 1.0) row[i - r.u0] = float(weight * double(row[i - r.u0]));
      }
    };
    if (j >= inner.v0 && j < inner.v1) {
      weigh(r.u0, inner.u0);
      weigh(inner.u1, r.u1);
    } else {
      weigh(r.u0, r.u1);
    }
  }
}

void hbSliceCompositor::composite(const Piece& piece, Part& part, hbProgress& progress) const {
  const hbPool<Scratch>::Lease scratch(memory_.scratch);
  scratch->sampler.restart();
  const bool isSum = mode_ == hbMode::xray;
  const float nothing = isSum ? 0.0F : -float(kInfinity);
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * std::size_t(piece.v1 - piece.v0);
  const auto place = [&](const Rectangle& r) { return std::size_t(r.u0) + stride * std::size_t(r.v0 - piece.v0); };
  const auto fill = [&](std::vector<float>& slice, const Rectangle& r) {
    for (int j = r.v0; j < r.v1; ++j) {
      float* const row = slice.data() + stride * std::size_t(j - piece.v0);
      std::fill(row + r.u0, row + std::max(r.u0, r.u1), nothing);
    }
  };
  part.values.assign(size, double(nothing));
  part.isEmpty = true;
  for (int begin = piece.begin; begin < piece.end; begin += Scratch::kGroup) {
    const int end = std::min(piece.end, begin + Scratch::kGroup);
    Rectangle all;
    std::array<Rectangle, Scratch::kGroup> each;
    for (int n = begin; n < end; ++n) {
      each[std::size_t(n - begin)] = sampler_.rectangle(n, piece.v0, piece.v1);
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
      if (isSum) weighEnds(n, r, slice.data() + place(r));
      fill(slice, {all.u0, all.u1, all.v0, r.v0});
      fill(slice, {all.u0, all.u1, r.v1, all.v1});
      fill(slice, {all.u0, r.u0, r.v0, r.v1});
      fill(slice, {r.u1, all.u1, r.v0, r.v1});
    }
    for (int j = all.v0; j < all.v1; ++j) {
      const std::size_t at = std::size_t(all.u0) + stride * std::size_t(j - piece.v0);
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

void hbSliceCompositor::findCrossings(const Piece& piece, Part& part, hbProgress& progress) const {
  const hbPool<Scratch>::Lease scratch(memory_.scratch);
  scratch->sampler.restart();
  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * std::size_t(piece.v1 - piece.v0);
  const auto place = [&](const Rectangle& r) { return std::size_t(r.u0) + stride * std::size_t(r.v0 - piece.v0); };
  part.values.assign(size, kInfinity);
  part.isEmpty = false;
  std::vector<float>&before = scratch->slices[0], &now = scratch->slices[1];
  for (std::vector<float>* slice : {&before, &now})
    if (slice->size() < size) slice->resize(size);
  Rectangle rectangleBefore;
  // The last slice of the chunk before is looked at again: a crossing lies between two.
  for (int n = std::max(rays_.firstSlice(), piece.begin - 1); n < piece.end; ++n) {
    const Rectangle r = sampler_.rectangle(n, piece.v0, piece.v1);
    if (!r.isEmpty()) sampler_.sample(n, r, scratch->sampler, float(kNaN), now.data() + place(r));
    const Rectangle both = r.intersect(rectangleBefore);
    for (int j = both.v0; j < both.v1; ++j) {
      const std::size_t first = std::size_t(both.u0) + stride * std::size_t(j - piece.v0),
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
    if (n >= piece.begin) progress.advance(1);
  }
}

void hbSliceCompositor::merge(int v0, int v1, std::span<const Part> parts, std::span<double> result) const {
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
  for (int j = v0; j < v1; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t at = i + columns * std::size_t(j - v0);
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
  tasks_.run(
      *parts,
      [&](const Piece& piece, Part& part) {
        if (mode_ == hbMode::iso)
          findCrossings(piece, part, progress);
        else
          composite(piece, part, progress);
      },
      [&](int v0, int v1, std::span<const Part> ofBand) {
        merge(v0, v1, ofBand, std::span(result).subspan(columns * std::size_t(v0), columns * std::size_t(v1 - v0)));
      });
  return result;
}
