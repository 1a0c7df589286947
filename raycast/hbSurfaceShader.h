#pragma once

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "volume/hbField.h"

/// Points of the cube collected for one call of a field.
struct hbPointBatch {
  std::vector<float> x, y, z, value;

  void clear() {
    x.clear();
    y.clear();
    z.clear();
  }
  void add(const glm::dvec3& p) {
    x.push_back(float(p.x));
    y.push_back(float(p.y));
    z.push_back(float(p.z));
  }
  std::size_t size() const { return x.size(); }
  void evaluate(const hbField& field, int component) {
    value.resize(size());
    field.values({x, y, z}, component, value);
  }
};

/// What an iso-surface looks like where it was found. One thread each.
class hbSurfaceShader {
public:
  /// Keeps a reference to `field`.
  hbSurfaceShader(const hbField& field, int component);

  /// The field's values at places of the cube, and world normals towards the viewer: the central differences over one
  /// sample spacing, one-sided at the cube's faces, turned against the rays (unit vectors of the world), or the rays
  /// reversed where the differences vanish. Seven values a place.
  void shade(std::span<const glm::dvec3> places, std::span<const glm::dvec3> rays);

  const std::vector<float>& values() const { return values_; }
  const std::vector<glm::dvec3>& normals() const { return normals_; }

private:
  void takeDifferences(std::span<const glm::dvec3> places);

  const hbField& field_;
  int component_;
  glm::dmat3 gradientToWorld_; ///< The inverse transpose of cube to world.
  hbPointBatch batch_;
  std::vector<float> values_;
  std::vector<glm::dvec3> normals_;
};
