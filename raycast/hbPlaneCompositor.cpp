#include "raycast/hbPlaneCompositor.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include <glm/geometric.hpp>

#include "raycast/hbLitPieces.h"
#include "raycast/hbSurfaceShader.h"

hbPlaneCompositor::hbPlaneCompositor(const hbPlaneRays& rays) : rays_(rays) {
  const std::size_t pixels = rays.rays().size();
  const hbMode mode = rays.scene().mode;
  if (mode == hbMode::xray) sums_.assign(pixels, 0.0);
  if (mode != hbMode::xray) greatest_.assign(pixels, -std::numeric_limits<float>::infinity());
  if (mode == hbMode::iso) isFound_.assign(pixels, false);
  if (mode != hbMode::dvr) return;
  matter_.emplace(rays.scene(), rays.field().valueMap(), rays.step());
  lights_.resize(pixels);
  if (hbLitPieces::areIn(rays.scene())) lit_ = std::make_unique<hbLitPieces>(rays.field(), rays.scene(), *matter_);
}

hbPlaneCompositor::~hbPlaneCompositor() = default;

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
    case hbMode::dvr:
      composite(i, index, value);
      break;
    case hbMode::slice: // hbPlaneRays refuses it
      break;
    }
  }
  if (lit_) lit_->compose();
}

void hbPlaneCompositor::composite(std::size_t pixel, int index, float value) {
  const hbPlaneRays::Ray& ray = rays_.rays()[pixel];
  if (lights_[pixel].isOpaque()) return;
  if (!matter_->isPreintegrated()) return addPiece(pixel, matter_->at(value), rays_.share(ray, index), index);
  // What lies before the first plane and behind the last has their values.
  const double step = rays_.step() / ray.cosine;
  if (index == ray.first)
    addPiece(pixel, matter_->slab(value, value), ray.before, index - 0.5 * ray.before / step);
  else
    addPiece(pixel, matter_->slab(greatest_[pixel], value), step, index - 0.5);
  greatest_[pixel] = value;
  if (index == ray.last) addPiece(pixel, matter_->slab(value, value), ray.behind, index + 0.5 * ray.behind / step);
}

/// `place`: of its middle.
void hbPlaneCompositor::addPiece(std::size_t pixel, const glm::vec4& piece, double length, double place) {
  hbEmissionAbsorption& light = lights_[pixel];
  if (!(piece.a > 0.0F) || light.isOpaque()) return;
  if (lit_)
    lit_->add(piece, length, rays_.at(pixel, place), rays_.direction(pixel), light);
  else
    matter_->addPiece(piece, length, light);
}

hbPicture hbPlaneCompositor::finish() const {
  switch (rays_.scene().mode) {
  case hbMode::xray:
    return rays_.xray(sums_);
  case hbMode::mip:
    return rays_.mip(greatest_);
  case hbMode::iso:
    return rays_.iso(shaded());
  case hbMode::dvr:
  case hbMode::slice:
    break;
  }
  std::vector<glm::vec4> shown;
  for (const hbEmissionAbsorption& light : lights_) shown.push_back(light.shown());
  return rays_.dvr(shown, *matter_);
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
