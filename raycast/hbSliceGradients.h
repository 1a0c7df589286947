#pragma once

#include <array>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "raycast/hbSliceSampler.h"

/// The gradients that intermediate rays are shaded with: those of hbCentralDifferences, from lattices one sample
/// spacing beside a slice, two along each axis.
class hbSliceGradients {
public:
  /// Memory that evaluate() uses again and again, and what it has found; one a thread, to be restarted for every frame.
  struct Scratch {
    hbSliceSampler::Scratch sampler;
    std::array<hbSliceSampler::Lattice, 4> beside; ///< Before and behind along the fast axis, and along the row axis.
    hbSliceSampler::Lattice here;
    std::array<std::vector<float>, 3> slopes; ///< Of the cube.
    std::vector<float> lower;
    std::vector<double> us, vs;

    void restart();
  };

  /// Keeps references to `rays` and `sampler`.
  hbSliceGradients(const hbShearFactorisation& rays, const hbSliceSampler& sampler, const hbGeometry& geometry);

  /// For the rays of the rectangle at a place among the slices, or as near to it as the cube is: at() has that of ray
  /// (i, j) at (i - r.u0) + rays.u().count (j - r.v0) then. Six lattices.
  void evaluate(double place, const hbSliceSampler::Rectangle& r, Scratch& scratch) const;

  /// Of the world, in field values per world length.
  glm::dvec3 at(const Scratch& scratch, std::size_t i) const {
    return toWorld_ * glm::dvec3(scratch.slopes[0][i], scratch.slopes[1][i], scratch.slopes[2][i]);
  }

  /// What scratch takes for so many rays, in bytes.
  static double bytes(double rays) { return 4.0 * sizeof(float) * rays; }

private:
  const hbShearFactorisation& rays_;
  const hbSliceSampler& sampler_;
  glm::dvec3 spacing_; ///< Of samples in the cube; 0 along flat axes.
  glm::dmat3 toWorld_; ///< The inverse transpose of cube to world.
};
