#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raycast/hbPool.h"
#include "raycast/hbRayChords.h"
#include "raycast/hbSliceSampler.h"
#include "raycast/hbSliceTasks.h"
#include "scene/hbMode.h"
#include "volume/hbProgress.h"

/// Goes through the slices of a factorisation and gives each intermediate ray what it meets.
class hbSliceCompositor {
public:
  /// Memory that tasks and frames use again and again.
  struct Memory;

  /// Keeps references to everything. `iso` is a field value, for the mode iso alone.
  hbSliceCompositor(const hbShearFactorisation& rays, const hbSliceSampler::Source& source, hbMode mode, float iso,
                    Memory& memory);

  /// One number a ray, that of (a, b) = (u.at(i), v.at(j)) at i + u.count j. X-ray: the mean of the field on the slices
  /// where the ray lies in the cube, each weighted by what it stands for of the ray, summed in 64 bits; MIP: the
  /// greatest; NaN where there is no such slice. Iso: the place among the slices, n + t, where the ray first crosses
  /// the iso-value, by linear interpolation between slices n and n + 1; infinite where it does not. A value equal to
  /// the iso-value counts as above.
  ///
  /// In parallel, see hbSliceTasks. Throws hbCancelled. O(slices x rays in the cube) evaluations.
  std::vector<double> run(hbProgress& progress) const;
  /// What run() reports to progress.
  std::int64_t steps() const;
  /// What run() takes at its peak with the result, in bytes.
  double bytes() const;

private:
  using Rectangle = hbSliceSampler::Rectangle;
  using Piece = hbSliceTasks::Piece;
  struct Part;
  struct Scratch;

  void composite(const Piece& piece, Part& part, hbProgress& progress) const;
  void weighEnds(int n, const Rectangle& r, float* out) const;
  void findCrossings(const Piece& piece, Part& part, hbProgress& progress) const;
  void merge(int v0, int v1, std::span<const Part> parts, std::span<double> result) const;

  const hbShearFactorisation& rays_;
  hbSliceSampler sampler_;
  hbRayChords chords_;
  hbSliceTasks tasks_;
  hbMode mode_;
  float iso_;
  Memory& memory_;
};

struct hbSliceCompositor::Part {
  std::vector<double> values;
  bool isEmpty = true;
};

/// Of one task.
struct hbSliceCompositor::Scratch {
  static constexpr int kGroup = 4; ///< Slices that are added up at once.
  hbSliceSampler::Scratch sampler;
  std::array<std::vector<float>, kGroup> slices;
};

struct hbSliceCompositor::Memory {
  hbPool<Scratch> scratch;
  hbPool<std::vector<Part>> parts;
};
