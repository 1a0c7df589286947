#include "raycast/hbPlaneCompositor.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include <glm/geometric.hpp>

#include "raycast/hbSurfaceShader.h"

hbPlaneCompositor::hbPlaneCompositor(const hbPlaneRays& rays) : rays_(rays) {
  const std::size_t pixels = rays.rays().size();
  const hbMode mode = rays.scene().mode;
  if (mode == hbMode::xray) sums_.assign(pixels, 0.0);
  if (mode != hbMode::xray) greatest_.assign(pixels, -std::numeric_limits<float>::infinity());
  if (mode == hbMode::iso) isFound_.assign(pixels, false);
}

void hbPlaneCompositor::add(int index, std::span<const float> values) {
  assert(index == added_ && values.size() == rays_.rays().size());
  ++added_;
  const float iso = rays_.iso();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const hbPlaneRays::Ray& ray = rays_.rays()[i];
    if (index < ray.first || index > ray.last) continue;
    const float value = values[i];
    switch (rays_.scene().mode) {
    case hbMode::xray:
      sums_[i] += double(value);
      break;
    case hbMode::mip:
      greatest_[i] = std::max(greatest_[i], value);
      break;
    case hbMode::iso:
      if (!isFound_[i] && index > ray.first && (greatest_[i] >= iso) != (value >= iso)) {
        const double t = (double(iso) - double(greatest_[i])) / (double(value) - double(greatest_[i]));
        crossings_.push_back({i, index - 1 + std::clamp(t, 0.0, 1.0)});
        isFound_[i] = true;
      }
      greatest_[i] = value;
      break;
    case hbMode::dvr: // hbPlaneRays refuses both
    case hbMode::slice:
      break;
    }
  }
}

hbPicture hbPlaneCompositor::finish() const {
  switch (rays_.scene().mode) {
  case hbMode::xray:
    return rays_.xray(sums_);
  case hbMode::mip:
    return rays_.mip(greatest_);
  case hbMode::iso:
  case hbMode::dvr:
  case hbMode::slice:
    break;
  }
  return rays_.iso(shaded());
}

std::vector<hbPlaneRays::Surface> hbPlaneCompositor::shaded() const {
  std::vector<glm::dvec3> places, directions;
  for (const hbPlaneRays::Surface& crossing : crossings_) {
    places.push_back(rays_.at(crossing.pixel, crossing.place));
    directions.push_back(rays_.direction(crossing.pixel));
  }
  hbSurfaceShader shader(rays_.field(), rays_.scene().component);
  shader.shade(places, directions);
  std::vector<hbPlaneRays::Surface> surfaces = crossings_;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    surfaces[i].normal = shader.normals()[i];
    surfaces[i].light = -glm::dot(shader.normals()[i], directions[i]);
    surfaces[i].value = shader.values()[i];
  }
  return surfaces;
}
