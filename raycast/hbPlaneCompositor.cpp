#include "raycast/hbPlaneCompositor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "raycast/hbRaySegment.h"
#include "raycast/hbSurfaceShader.h"
#include "volume/hbError.h"

hbPlaneCompositor::hbPlaneCompositor(const hbField& field, const hbScene& scene)
    : field_(field), scene_(scene), camera_(scene.cameraFor(field.geometry())),
      worldToCube_(glm::inverse(field.geometry().cubeToWorld())) {
  scene.validate();
  if (scene.component < 0 || scene.component >= field.components())
    throw hbError(fmt::format("component: expected 0 to {}, found {}", field.components() - 1, scene.component));
  if (scene.mode == hbMode::iso && !scene.isoValue) throw hbError("iso: expected an iso-value");
  if (scene.isoValue) iso_ = float(field.valueMap().fromTrue(*scene.isoValue));
  planes_ = scene.sampling.planes(field.geometry(), camera_);
  near_ = hbSampling::extent(field.geometry(), camera_).near;
  step_ = scene.sampling.stepLength(field.geometry(), camera_);

  const std::size_t pixels = std::size_t(scene.width) * std::size_t(scene.height);
  rays_.resize(pixels);
  const glm::dvec3 axis = camera_.viewAxis();
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) {
      const hbRay ray = camera_.ray(x + 0.5, y + 0.5, scene.width, scene.height);
      const auto segment = hb::clipToCube(ray, worldToCube_);
      const double cosine = glm::dot(ray.direction, axis);
      if (!segment || !(cosine > 0.0)) continue;
      // As hbRaycaster has it; rays of both projections start on the plane through the camera's position.
      const double start = glm::dot(ray.origin - camera_.position, axis);
      const auto place = [&](double way) { return (start + way * cosine - near_) / step_ - 0.5; };
      rays_[std::size_t(x) + std::size_t(scene.width) * std::size_t(y)] = {
          std::int32_t(std::max(0.0, std::ceil(place(segment->enter)))),
          std::int32_t(std::min(planes_ - 1.0, std::floor(place(segment->leave)))), cosine};
    }
  if (scene.mode == hbMode::xray) sums_.assign(pixels, 0.0);
  if (scene.mode != hbMode::xray) greatest_.assign(pixels, -std::numeric_limits<float>::infinity());
  if (scene.mode == hbMode::iso) isFound_.assign(pixels, false);
}

hbPlaneCompositor::Plane hbPlaneCompositor::plane(int index) const {
  // Where three corners of the picture see the plane; in between it is affine, for both projections.
  const auto at = [&](double px, double py) {
    const hbRay ray = camera_.ray(px, py, scene_.width, scene_.height);
    const double way = distance(index) / glm::dot(ray.direction, camera_.viewAxis());
    return glm::dvec3(worldToCube_ * glm::dvec4(ray.origin + way * ray.direction, 1.0));
  };
  const glm::dvec3 corner = at(0.0, 0.0);
  return {corner, (at(scene_.width, 0.0) - corner) / double(scene_.width),
          (at(0.0, scene_.height) - corner) / double(scene_.height)};
}

void hbPlaneCompositor::add(int index, std::span<const float> values) {
  assert(index == added_ && values.size() == rays_.size());
  ++added_;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (index < rays_[i].first || index > rays_[i].last) continue;
    const float value = values[i];
    switch (scene_.mode) {
    case hbMode::xray:
      sums_[i] += double(value);
      break;
    case hbMode::mip:
      greatest_[i] = std::max(greatest_[i], value);
      break;
    case hbMode::iso:
      if (!isFound_[i] && index > rays_[i].first && (greatest_[i] >= iso_) != (value >= iso_)) {
        const double t = (double(iso_) - double(greatest_[i])) / (double(value) - double(greatest_[i]));
        crossings_.push_back({i, index - 1 + std::clamp(t, 0.0, 1.0)});
        isFound_[i] = true;
      }
      greatest_[i] = value;
      break;
    }
  }
}

hbPicture hbPlaneCompositor::finish() {
  hbPicture picture;
  picture.width = scene_.width;
  picture.height = scene_.height;
  hbScene scene = scene_;
  scene.camera = camera_;
  picture.metadata[hbPicture::kSceneKey] = hb::toJson(scene);
  std::vector<float>&y = picture.add("Y"), &a = picture.add("A");
  if (scene_.mode == hbMode::iso) {
    shade(picture);
    return picture;
  }
  const hbValueMap map = field_.valueMap();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Ray& ray = rays_[i];
    if (ray.last < ray.first) continue;
    a[i] = 1.0F;
    const double weight = step_ / ray.cosine, length = double(ray.last - ray.first + 1) * weight;
    y[i] = scene_.mode == hbMode::mip ? float(map.toTrue(greatest_[i]))
                                      : float(map.scale * sums_[i] * weight + map.offset * length);
  }
  return picture;
}

void hbPlaneCompositor::shade(hbPicture& picture) const {
  std::vector<float>&z = picture.add("Z", std::numeric_limits<float>::infinity()), &nx = picture.add("N.X"),
  &ny = picture.add("N.Y"), &nz = picture.add("N.Z"), &value = picture.add("value"), &y = picture.channels["Y"];
  std::vector<glm::dvec3> places, rays;
  for (const Crossing& c : crossings_) {
    const int px = int(c.pixel % std::size_t(scene_.width)), py = int(c.pixel / std::size_t(scene_.width));
    const hbRay ray = camera_.ray(px + 0.5, py + 0.5, scene_.width, scene_.height);
    const double way = distance(c.place) / rays_[c.pixel].cosine;
    places.emplace_back(worldToCube_ * glm::dvec4(ray.origin + way * ray.direction, 1.0));
    rays.push_back(ray.direction);
  }
  hbSurfaceShader shader(field_, scene_.component);
  shader.shade(places, rays);
  for (std::size_t i = 0; i < crossings_.size(); ++i) {
    const std::size_t pixel = crossings_[i].pixel;
    const glm::dvec3& normal = shader.normals()[i];
    y[pixel] = float(-glm::dot(normal, rays[i]));
    picture.channels["A"][pixel] = 1.0F;
    z[pixel] = float(distance(crossings_[i].place));
    nx[pixel] = float(normal.x);
    ny[pixel] = float(normal.y);
    nz[pixel] = float(normal.z);
    value[pixel] = float(field_.valueMap().toTrue(shader.values()[i]));
  }
}
