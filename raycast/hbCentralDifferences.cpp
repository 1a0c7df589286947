#include "raycast/hbCentralDifferences.h"

#include <algorithm>

#include <glm/matrix.hpp>

hbCentralDifferences::hbCentralDifferences(const hbField& field, int component)
    : field_(field), component_(component),
      toWorld_(glm::transpose(glm::dmat3(glm::inverse(field.geometry().cubeToWorld())))) {}

const std::vector<glm::dvec3>& hbCentralDifferences::at(std::span<const glm::dvec3> places) {
  const glm::dvec3 h = field_.geometry().cubeSpacing();
  gradients_.assign(places.size(), glm::dvec3(0.0));
  span_.resize(places.size());
  for (int d = 0; d < 3; ++d) {
    if (field_.geometry().isFlat(d)) continue;
    batch_.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      glm::dvec3 lower = places[i], upper = places[i];
      lower[d] = std::max(0.0, lower[d] - h[d]);
      upper[d] = std::min(1.0, upper[d] + h[d]);
      batch_.add(lower);
      batch_.add(upper);
      span_[i] = upper[d] - lower[d];
    }
    batch_.evaluate(field_, component_);
    for (std::size_t i = 0; i < places.size(); ++i)
      gradients_[i][d] = (double(batch_.value[2 * i + 1]) - double(batch_.value[2 * i])) / span_[i];
  }
  for (glm::dvec3& gradient : gradients_) gradient = toWorld_ * gradient;
  return gradients_;
}
