#include "raycast/hbCentralDifferences.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <glm/matrix.hpp>

hbCentralDifferences::hbCentralDifferences(const hbField& field, int component)
    : field_(field), component_(component),
      toWorld_(glm::transpose(glm::dmat3(glm::inverse(field.geometry().cubeToWorld())))) {}

const std::vector<glm::dvec3>& hbCentralDifferences::at(std::span<const glm::dvec3> places) {
  const glm::dvec3 h = field_.geometry().cubeSpacing();
  gradients_.assign(places.size(), glm::dvec3(0.0));
  const auto ends = [&](const glm::dvec3& place, int d) {
    return std::pair(std::max(0.0, place[d] - h[d]), std::min(1.0, place[d] + h[d]));
  };
  batch_.clear();
  for (int d = 0; d < 3; ++d) {
    if (field_.geometry().isFlat(d)) continue;
    for (const glm::dvec3& place : places) {
      glm::dvec3 lower = place, upper = place;
      std::tie(lower[d], upper[d]) = ends(place, d);
      batch_.add(lower);
      batch_.add(upper);
    }
  }
  batch_.evaluate(field_, component_);
  const float* value = batch_.value.data();
  for (int d = 0; d < 3; ++d) {
    if (field_.geometry().isFlat(d)) continue;
    for (std::size_t i = 0; i < places.size(); ++i, value += 2) {
      const auto [lower, upper] = ends(places[i], d);
      gradients_[i][d] = (double(value[1]) - double(value[0])) / (upper - lower);
    }
  }
  for (glm::dvec3& gradient : gradients_) gradient = toWorld_ * gradient;
  return gradients_;
}
