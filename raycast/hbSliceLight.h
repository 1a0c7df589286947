#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "raycast/hbPool.h"
#include "raycast/hbRayChords.h"
#include "raycast/hbSliceGradients.h"
#include "raycast/hbSliceSampler.h"
#include "raycast/hbSliceTasks.h"
#include "raycast/hbVisibility.h"
#include "scene/hbScene.h"
#include "volume/hbProgress.h"

/// Goes through the slices of a factorisation and gives each intermediate ray the light that it sees in the mode dvr.
class hbSliceLight {
public:
  /// Memory that tasks and frames use again and again.
  struct Memory;

  /// Below this transmittance a ray ends, within a chunk of slices: a chunk does not know what lies before it.
  /// kOpaque's square, since it is shown over the length of a pixel's own ray: over half of the length it is kOpaque.
  static constexpr double kOpaque = hbEmissionAbsorption::kOpaque * hbEmissionAbsorption::kOpaque;

  /// Keeps references to everything but `geometry`. Of the scene, `shading` and `gradientOpacity` are looked at.
  hbSliceLight(const hbShearFactorisation& rays, const hbSliceSampler::Source& source, const hbMatter& matter,
               const hbVisibility& visibility, const hbGeometry& geometry, const hbScene& scene, Memory& memory);
  hbSliceLight(const hbSliceLight&) = delete;
  hbSliceLight& operator=(const hbSliceLight&) = delete;

  /// What each ray, that of (a, b) = (u.at(i), v.at(j)) at i + u.count j, shows: the constant matter that shows the
  /// same over the ray's length in the cube. NaN as its extinction where no slice meets the ray in the cube.
  ///
  /// A slice's value stands for as much of the ray as it does in an X-ray (hbRayChords); pre-integrated, slabs lie
  /// between two slices, and what lies before the first and behind the last has their values. A value is lit at its
  /// slice, with the gradient there; pre-integrated, a slab between two slices, and what lies before the first and
  /// behind the last half a slice before that. Composited in 64 bits, front to back, in parallel, see hbSliceTasks.
  /// Throws hbCancelled. O(slices x rays in the cube) evaluations.
  std::vector<glm::vec4> run(hbProgress& progress) const;
  /// What run() reports to progress.
  std::int64_t steps() const { return tasks_.steps(); }
  /// What run() takes at its peak with the result, in bytes.
  double bytes() const;

private:
  using Rectangle = hbSliceSampler::Rectangle;
  using Piece = hbSliceTasks::Piece;
  struct Part;
  struct Scratch;
  /// A row of rays in a slice, and what they have seen. Pointers are to that of ray u.at(0).
  struct Row {
    int n = 0, j = 0;
    const float *before = nullptr, *now = nullptr; ///< Values in the slice before, if pre-integrated, and in n.
    const float* slabs = nullptr;                  ///< World lengths from slice to slice.
    hbEmissionAbsorption* light = nullptr;
    const hbSliceGradients::Scratch* gradients = nullptr; ///< If lit: that of ray u0 is at `at`.
    std::size_t at = 0;
    int u0 = 0;
  };

  void composite(const Piece& piece, std::span<const float> slabs, Part& part, hbProgress& progress) const;
  void addSlice(int n, const Rectangle& r, const Piece& piece, std::span<const float> slabs, Scratch& scratch,
                Part& part) const;
  Row rowOf(int n, int j, const Piece& piece, std::span<const float> slabs, const Scratch& scratch, Part& part) const;
  /// From the first to the last row of the rectangle in which something shows, each of them whole: what is beside a
  /// sample in its row may change its last bit.
  Rectangle litRows(int n, const Rectangle& r, const Piece& piece, std::span<const float> slabs, const Scratch& scratch,
                    Part& part) const;
  /// Where light comes from in slice n: the place among the slices.
  double litAt(int n) const { return matter_.isPreintegrated() ? n - 0.5 : n; }
  /// A piece of ray i, of hbMatter::at() or slab(), so long in the world.
  void add(const Row& row, int i, const glm::vec4& piece, double length) const {
    if (!(piece.a > 0.0F)) return;
    if (row.gradients)
      addLit(row, i, piece, length);
    else
      matter_.addPiece(piece, length, row.light[i]);
  }
  void addLit(const Row& row, int i, const glm::vec4& piece, double length) const;
  /// Rays u0 to u1 of a row, which go on through the cube before and after the slice.
  void addInner(const Row& row, int u0, int u1) const;
  /// Any.
  void addEnds(const Row& row, int u0, int u1) const;
  bool isInvisible(const Row& row, int u0, int u1) const;
  /// World lengths of all rays from slice to slice.
  std::vector<float> slabs() const;
  /// Rows v0 to v1 of the result.
  void merge(int v0, int v1, std::span<const float> slabs, std::span<const Part> parts,
             std::span<glm::vec4> result) const;

  const hbShearFactorisation& rays_;
  hbSliceSampler sampler_;
  hbRayChords chords_;
  hbSliceTasks tasks_;
  const hbMatter& matter_;
  const hbVisibility& visibility_;
  const hbScene& scene_;
  hbSliceGradients gradients_;
  glm::dmat4 cubeToWorld_;
  bool isLit_;
  /// From slice to slice in the world, the ray of (a, b) goes way_ + a wayOfA_ + b wayOfB_.
  glm::dvec3 way_, wayOfA_, wayOfB_;
  Memory& memory_;
};

struct hbSliceLight::Part {
  std::vector<hbEmissionAbsorption> light;
  bool isEmpty = true;
};

/// Of one task.
struct hbSliceLight::Scratch {
  hbSliceSampler::Scratch sampler;
  std::vector<float> before, now;
  hbSliceGradients::Scratch gradients;
};

struct hbSliceLight::Memory {
  hbPool<Scratch> scratch;
  hbPool<std::vector<Part>> parts;
};
