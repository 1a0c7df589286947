#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "raycast/hbCentralDifferences.h"

/// What an iso-surface looks like where it was found. One thread each.
class hbSurfaceShader {
public:
  /// Keeps a reference to `field`.
  hbSurfaceShader(const hbField& field, int component);

  /// The field's values at places of the cube, and world normals towards the viewer: the central differences turned
  /// against the rays (unit vectors of the world), or the rays reversed where the differences vanish. Seven values a
  /// place.
  void shade(std::span<const glm::dvec3> places, std::span<const glm::dvec3> rays);

  const std::vector<float>& values() const { return values_; }
  const std::vector<glm::dvec3>& normals() const { return normals_; }

private:
  const hbField& field_;
  int component_;
  hbCentralDifferences differences_;
  hbPointBatch batch_;
  std::vector<float> values_;
  std::vector<glm::dvec3> normals_;
};
