#include "raycast/hbSurfaceShader.h"

#include <glm/geometric.hpp>

hbSurfaceShader::hbSurfaceShader(const hbField& field, int component)
    : field_(field), component_(component), differences_(field, component) {}

void hbSurfaceShader::shade(std::span<const glm::dvec3> places, std::span<const glm::dvec3> rays) {
  batch_.clear();
  for (const glm::dvec3& p : places) batch_.add(p);
  batch_.evaluate(field_, component_);
  values_ = batch_.value;
  normals_ = differences_.at(places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double length = glm::length(normals_[i]);
    const glm::dvec3 normal = length > 0.0 ? normals_[i] / length : -rays[i];
    normals_[i] = glm::dot(normal, rays[i]) > 0.0 ? -normal : normal;
  }
}
