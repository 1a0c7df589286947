#include "raycast/hbSurfaceShader.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

hbSurfaceShader::hbSurfaceShader(const hbField& field, int component)
    : field_(field), component_(component),
      gradientToWorld_(glm::transpose(glm::dmat3(glm::inverse(field.geometry().cubeToWorld())))) {}

void hbSurfaceShader::shade(std::span<const glm::dvec3> places, std::span<const glm::dvec3> rays) {
  batch_.clear();
  for (const glm::dvec3& p : places) batch_.add(p);
  batch_.evaluate(field_, component_);
  values_ = batch_.value;
  takeDifferences(places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    glm::dvec3 normal = gradientToWorld_ * normals_[i];
    const double length = glm::length(normal);
    normal = length > 0.0 ? normal / length : -rays[i];
    normals_[i] = glm::dot(normal, rays[i]) > 0.0 ? -normal : normal;
  }
}

void hbSurfaceShader::takeDifferences(std::span<const glm::dvec3> places) {
  const glm::dvec3 h = field_.geometry().cubeSpacing();
  normals_.assign(places.size(), glm::dvec3(0.0));
  std::vector<double> span(places.size());
  for (int d = 0; d < 3; ++d) {
    if (field_.geometry().isFlat(d)) continue;
    batch_.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      glm::dvec3 lower = places[i], upper = places[i];
      lower[d] = std::max(0.0, lower[d] - h[d]);
      upper[d] = std::min(1.0, upper[d] + h[d]);
      batch_.add(lower);
      batch_.add(upper);
      span[i] = upper[d] - lower[d];
    }
    batch_.evaluate(field_, component_);
    for (std::size_t i = 0; i < places.size(); ++i)
      normals_[i][d] = (double(batch_.value[2 * i + 1]) - double(batch_.value[2 * i])) / span[i];
  }
}
