#pragma once

#include <vector>

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
