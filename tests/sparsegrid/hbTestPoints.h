#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <vector>

#include <glm/vec3.hpp>

#include "volume/hbField.h"

/// Points to evaluate sparse grids at, and what comes out.
struct hbTestPoints {
  std::vector<float> x, y, z;

  hbPoints view() const { return {x, y, z}; }
  glm::vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  std::size_t size() const { return x.size(); }

  /// Always the same ones.
  static hbTestPoints random(std::size_t count) {
    std::mt19937 random(12345);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    hbTestPoints p;
    for (auto* axis : {&p.x, &p.y, &p.z})
      for (std::size_t i = 0; i < count; ++i) axis->push_back(std::min(unit(random), 1.0F));
    return p;
  }

  /// All triples of coordinates at which evaluations go wrong: nodes, faces, outside, tiny, NaN.
  static hbTestPoints awkward() {
    const std::array<float, 10> list{0.0F,   1.0F,   0.5F, 0.34375F,    0.984375F,
                                     1e-30F, -0.25F, 1.5F, 0.99999994F, std::numeric_limits<float>::quiet_NaN()};
    hbTestPoints p;
    for (const float z : list)
      for (const float y : list)
        for (const float x : list) {
          p.x.push_back(x);
          p.y.push_back(y);
          p.z.push_back(z);
        }
    return p;
  }
};

/// The points in 64 bits.
struct hbTestPoints64 {
  std::vector<double> x, y, z;

  explicit hbTestPoints64(const hbTestPoints& p)
      : x(p.x.begin(), p.x.end()), y(p.y.begin(), p.y.end()), z(p.z.begin(), p.z.end()) {}
  hbPoints64 view() const { return {x, y, z}; }
};

/// The values and the gradients of a field at points.
template <class Real>
struct hbTestValues {
  std::vector<Real> value, valueAgain, dx, dy, dz;

  template <class Field>
  hbTestValues(const Field& field, const hbPointsOf<Real>& points, int component = 0) {
    for (auto* v : {&value, &valueAgain, &dx, &dy, &dz}) v->resize(points.size());
    field.values(points, component, value);
    field.gradients(points, component, valueAgain, hbGradientsOf<Real>{dx, dy, dz});
  }
  glm::vec<3, Real> gradient(std::size_t i) const { return {dx[i], dy[i], dz[i]}; }
  bool operator==(const hbTestValues&) const = default;
};
