#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "raycast/hbRaySegment.h"
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
  /// The points of a ray at the world distances first + i * step, begin <= i < begin + count, and no others.
  void line(const hbRaySegment& ray, double first, double step, std::int32_t begin, std::int32_t count) {
    const auto fill = [&](std::vector<float>& axis, double origin, double direction) {
      axis.resize(std::size_t(count));
      float* to = axis.data();
      for (std::int32_t i = 0; i < count; ++i) to[i] = float(origin + (first + double(begin + i) * step) * direction);
    };
    fill(x, ray.origin.x, ray.direction.x);
    fill(y, ray.origin.y, ray.direction.y);
    fill(z, ray.origin.z, ray.direction.z);
  }
  std::size_t size() const { return x.size(); }
  void evaluate(const hbField& field, int component) {
    value.resize(size());
    field.values({x, y, z}, component, value);
  }
};
