#pragma once

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "raycast/hbPointBatch.h"

/// The gradient that pictures are shaded with, one for all representations of a volume: central differences over one
/// sample spacing, one-sided at the cube's faces. One thread each.
class hbCentralDifferences {
public:
  /// Keeps a reference to `field`.
  hbCentralDifferences(const hbField& field, int component);

  /// At places of the cube, six values each: in field values per world length, 0 along flat axes.
  const std::vector<glm::dvec3>& at(std::span<const glm::dvec3> places);

private:
  const hbField& field_;
  int component_;
  glm::dmat3 toWorld_; ///< The inverse transpose of cube to world.
  hbPointBatch batch_;
  std::vector<glm::dvec3> gradients_;
};
