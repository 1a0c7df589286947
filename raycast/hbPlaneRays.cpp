#include "raycast/hbPlaneRays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "raycast/hbMatterRay.h"
#include "raycast/hbPixelRays.h"
#include "raycast/hbPointBatch.h"
#include "raycast/hbSceneCheck.h"
#include "scene/hbColorSpace.h"
#include "volume/hbError.h"

hbPlaneRays::hbPlaneRays(const hbField& field, const hbScene& scene)
    : field_(field), scene_(scene), worldToCube_(glm::inverse(field.geometry().cubeToWorld())) {
  hb::checkScene(scene, field);
  scene_.camera = scene.cameraFor(field.geometry());
  scene_.sampling.kind = hbSampling::Kind::planewise;
  if (scene.mode == hbMode::slice) throw hbError("slice: expected an engine of the ray caster, found one of planes");
  if (scene.isoValue) iso_ = float(field.valueMap().fromTrue(*scene.isoValue));
  const hbCamera& camera = *scene_.camera;
  planes_ = scene.sampling.planes(field.geometry(), camera);
  near_ = hbSampling::extent(field.geometry(), camera).near;
  step_ = scene.sampling.stepLength(field.geometry(), camera);

  rays_.resize(std::size_t(scene.width) * std::size_t(scene.height));
  const glm::dvec3 axis = camera.viewAxis();
  for (std::size_t pixel = 0; pixel < rays_.size(); ++pixel) {
    const hbRay through = ray(pixel);
    const auto segment = clipped(through);
    const double cosine = glm::dot(through.direction, axis);
    if (!segment || !(cosine > 0.0)) continue;
    // As hbRaycaster has it; rays of both projections start on the plane through the camera's position.
    const double start = glm::dot(through.origin - camera.position, axis);
    const auto place = [&](double way) { return (start + way * cosine - near_) / step_ - 0.5; };
    Ray& made = rays_[pixel];
    made = {std::int32_t(std::max(0.0, std::ceil(place(segment->enter)))),
            std::int32_t(std::min(planes_ - 1.0, std::floor(place(segment->leave)))), cosine};
    const auto way = [&](int plane) { return (distance(plane) - start) / cosine; };
    const bool isBetween = made.last < made.first;
    made.before = isBetween ? 0.5 * segment->length() : std::max(0.0, way(made.first) - segment->enter);
    made.behind = isBetween ? 0.5 * segment->length() : std::max(0.0, segment->leave - way(made.last));
  }
}

hbRay hbPlaneRays::ray(std::size_t pixel) const {
  const auto width = std::size_t(scene_.width);
  return scene_.camera->ray(double(pixel % width) + 0.5, double(pixel / width) + 0.5, scene_.width, scene_.height);
}

std::optional<hbRaySegment> hbPlaneRays::clipped(const hbRay& through) const {
  const hbScene::ClipBox box = scene_.clip.value_or(hbScene::ClipBox{});
  return hb::clipToCube(through, worldToCube_, box.lo, box.hi);
}

glm::dvec3 hbPlaneRays::direction(std::size_t pixel) const { return ray(pixel).direction; }

glm::dvec3 hbPlaneRays::at(std::size_t pixel, double place) const {
  const hbRay through = ray(pixel);
  const double way = distance(place) / rays_[pixel].cosine;
  return worldToCube_ * glm::dvec4(through.origin + way * through.direction, 1.0);
}

hbPlaneRays::Plane hbPlaneRays::plane(int index) const {
  // Where three corners of the picture see the plane; in between it is affine, for both projections.
  const hbCamera& camera = *scene_.camera;
  const auto at = [&](double px, double py) {
    const hbRay through = camera.ray(px, py, scene_.width, scene_.height);
    const double way = distance(index) / glm::dot(through.direction, camera.viewAxis());
    return glm::dvec3(worldToCube_ * glm::dvec4(through.origin + way * through.direction, 1.0));
  };
  const glm::dvec3 corner = at(0.0, 0.0);
  return {corner, (at(scene_.width, 0.0) - corner) / double(scene_.width),
          (at(0.0, scene_.height) - corner) / double(scene_.height), window(index)};
}

hbPlaneRays::Window hbPlaneRays::window(int plane) const {
  const double way = distance(plane);
  if (scene_.camera->projection == hbCamera::Projection::perspective) {
    // A plane through the eye, but for rounding, is a point that every ray begins at; there is none behind it.
    if (std::abs(way) < 1e-9 * step_) return {0, 0, scene_.width, scene_.height};
    if (way < 0.0) return {};
  }
  // The plane cuts a polygon out of the cube, with its corners on edges of the cube.
  const hbPixelRays pixels(*scene_.camera, scene_.width, scene_.height, field_.geometry());
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int axis = 0; axis < 3; ++axis)
    for (const double u : {0.0, 1.0})
      for (const double v : {0.0, 1.0}) {
        glm::dvec3 a(0.0), b(0.0);
        a[(axis + 1) % 3] = b[(axis + 1) % 3] = u;
        a[(axis + 2) % 3] = b[(axis + 2) % 3] = v;
        b[axis] = 1.0;
        const double atA = pixels.distance(a), atB = pixels.distance(b);
        if (std::min(atA, atB) > way || std::max(atA, atB) < way) continue;
        for (const double t : atA == atB ? std::vector{0.0, 1.0} : std::vector{(way - atA) / (atB - atA)}) {
          const glm::dvec2 pixel = pixels.pixel(a + t * (b - a));
          low = glm::min(low, pixel);
          high = glm::max(high, pixel);
        }
      }
  // A pixel more on each side, for what is rounded.
  const glm::dvec2 size(scene_.width, scene_.height);
  low = glm::clamp(glm::floor(low) - 1.0, glm::dvec2(0.0), size);
  high = glm::clamp(glm::ceil(high) + 1.0, glm::dvec2(0.0), size);
  if (!(low.x < high.x && low.y < high.y)) return {};
  return {int(low.x), int(low.y), int(high.x - low.x), int(high.y - low.y)};
}

hbPicture hbPlaneRays::empty() const {
  hbPicture picture;
  picture.width = scene_.width;
  picture.height = scene_.height;
  picture.metadata[hbPicture::kSceneKey] = hb::toJson(scene_);
  picture.add("Y");
  picture.add("A");
  return picture;
}

hbPicture hbPlaneRays::xray(std::span<const double> sums) const {
  hbPicture picture = empty();
  std::vector<float>&y = picture.channels["Y"], &a = picture.channels["A"];
  const hbValueMap map = field_.valueMap();
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Ray& ray = rays_[i];
    if (ray.last < ray.first) continue;
    const double weight = step_ / ray.cosine, length = double(ray.last - ray.first + 1) * weight;
    y[i] = float(map.scale * sums[i] * weight + map.offset * length);
    a[i] = 1.0F;
  }
  return picture;
}

hbPicture hbPlaneRays::mip(std::span<const float> maxima) const {
  hbPicture picture = empty();
  std::vector<float>&y = picture.channels["Y"], &a = picture.channels["A"];
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (rays_[i].last < rays_[i].first) continue;
    y[i] = float(field_.valueMap().toTrue(maxima[i]));
    a[i] = 1.0F;
  }
  return picture;
}

hbPicture hbPlaneRays::iso(std::span<const Surface> surfaces) const {
  hbPicture picture = empty();
  std::vector<float>&z = picture.add("Z", std::numeric_limits<float>::infinity()), &nx = picture.add("N.X"),
  &ny = picture.add("N.Y"), &nz = picture.add("N.Z"), &value = picture.add("value"), &y = picture.channels["Y"],
  &a = picture.channels["A"];
  for (const Surface& surface : surfaces) {
    const std::size_t pixel = surface.pixel;
    y[pixel] = float(surface.light);
    a[pixel] = 1.0F;
    z[pixel] = float(distance(surface.place));
    nx[pixel] = float(surface.normal.x);
    ny[pixel] = float(surface.normal.y);
    nz[pixel] = float(surface.normal.z);
    value[pixel] = float(field_.valueMap().toTrue(surface.value));
  }
  return picture;
}

hbPicture hbPlaneRays::dvr(std::span<const glm::vec4> lights, const hbMatter& matter) const {
  std::vector<glm::vec4> shown(lights.begin(), lights.end());
  addBetween(shown, matter);
  hbPicture picture = empty();
  std::vector<float>&red = picture.add("R"), &green = picture.add("G"), &blue = picture.add("B"),
  &y = picture.channels["Y"], &a = picture.channels["A"];
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const glm::vec4& light = shown[i];
    red[i] = light.r;
    green[i] = light.g;
    blue[i] = light.b;
    y[i] = float(hb::linearToXyz(glm::dvec3(light)).y);
    a[i] = light.a;
  }
  return picture;
}

void hbPlaneRays::addBetween(std::span<glm::vec4> lights, const hbMatter& matter) const {
  std::vector<std::size_t> pixels;
  std::vector<hbRaySegment> segments;
  hbPointBatch batch;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (rays_[i].last >= rays_[i].first || !(rays_[i].before > 0.0)) continue;
    pixels.push_back(i);
    segments.push_back(*clipped(ray(i)));
    batch.add(segments.back().at(segments.back().enter + 0.5 * segments.back().length()));
  }
  if (pixels.empty()) return;
  batch.evaluate(field_, scene_.component);
  hbMatterRay along(field_, scene_, matter);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const glm::vec4 piece = matter.piece(batch.value[i]);
    const double length = segments[i].length();
    along.begin(ray(pixels[i]), segments[i]);
    // Slabs lie before the sample and behind it.
    if (matter.isPreintegrated()) {
      for (const double middle : {0.25, 0.75}) along.add(piece, 0.5 * length, segments[i].enter + middle * length);
    } else {
      along.add(piece, length, segments[i].enter + 0.5 * length);
    }
    lights[pixels[i]] = along.finish().shown();
  }
}
