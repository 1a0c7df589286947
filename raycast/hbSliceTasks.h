#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "raycast/hbShearFactorisation.h"
#include "volume/hbParallel.h"

/// The work on the slices of a factorisation in pieces, bands of rows of rays times chunks of slices, that are done in
/// parallel. The pieces do not depend on the number of threads, and what those of a band have found is put together in
/// order, front to back.
class hbSliceTasks {
public:
  /// Rows [v0, v1) in slices [begin, end).
  struct Piece {
    int v0 = 0, v1 = 0, begin = 0, end = 0;
  };

  /// Keeps a reference to `rays`.
  explicit hbSliceTasks(const hbShearFactorisation& rays) : rays_(rays) {
    const std::int64_t count = std::int64_t(rays.u().count) * rays.v().count;
    bands_ = int(std::min<std::int64_t>((count + kBandRays - 1) / kBandRays, rays.v().count));
    chunks_ = std::clamp((rays.endSlice() - rays.firstSlice() + kChunkSlices - 1) / kChunkSlices, 1, kMostChunks);
  }

  /// Slices of all pieces.
  std::int64_t steps() const { return std::int64_t(bands_) * (rays_.endSlice() - rays_.firstSlice()); }
  /// Rays of one piece, and of all pieces that are there at once.
  double raysAPiece() const { return double(rays_.u().count) * rays_.v().count / std::max(1, bands_); }
  double raysAtOnce() const { return raysAPiece() * chunks_ * std::min(kBandsAtOnce, bands_); }

  /// Calls work(piece, part) for every piece, and merge(v0, v1, parts) for the rows of every band with the parts of its
  /// pieces; `parts` is memory that is used again and again.
  template <class Part, class Work, class Merge>
  void run(std::vector<Part>& parts, Work work, Merge merge) const {
    for (int band = 0; band < bands_; band += kBandsAtOnce) {
      const int count = std::min(kBandsAtOnce, bands_ - band);
      if (parts.size() < std::size_t(count * chunks_)) parts.resize(std::size_t(count * chunks_));
      hb::parallelFor(std::int64_t(count) * chunks_, [&](std::int64_t task) {
        const int ofBand = band + int(task / chunks_), chunk = int(task % chunks_);
        work(Piece{rowOf(ofBand), rowOf(ofBand + 1), sliceOf(chunk), sliceOf(chunk + 1)}, parts[std::size_t(task)]);
      });
      hb::parallelFor(count, [&](std::int64_t k) {
        const int ofBand = band + int(k);
        merge(rowOf(ofBand), rowOf(ofBand + 1),
              std::span<const Part>(parts).subspan(std::size_t(k * chunks_), std::size_t(chunks_)));
      });
    }
  }

private:
  // Every part of a band has numbers of its own for each ray: few and large enough parts that putting them together
  // costs little, small enough that the slices of a group stay in the second-level cache.
  static constexpr std::int64_t kBandRays = 65536;
  static constexpr int kChunkSlices = 16, kMostChunks = 8;
  static constexpr int kBandsAtOnce = 4;

  /// First row or slice of a part; that of the next one ends it.
  int rowOf(int band) const { return int(std::int64_t(rays_.v().count) * band / bands_); }
  int sliceOf(int chunk) const {
    return rays_.firstSlice() + int(std::int64_t(rays_.endSlice() - rays_.firstSlice()) * chunk / chunks_);
  }

  const hbShearFactorisation& rays_;
  int bands_, chunks_;
};
