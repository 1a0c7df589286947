#include "raycast/hbPixelWarp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

#include "raycast/hbMatterRay.h"
#include "raycast/hbShearWarp.h"
#include "raycast/hbSurfaceShader.h"
#include "scene/hbColorSpace.h"
#include "volume/hbParallel.h"

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kRows = 8; // of pixels, a task

} // namespace

hbPixelWarp::hbPixelWarp(const hbPixelRays& rays, const hbScene& scene, const hbField& field, int component,
                         hbPicture& picture)
    : rays_(rays), scene_(scene), field_(field), component_(component),
      step_(scene.sampling.stepLength(field.geometry(), *scene.camera)), y_(&picture.add("Y")), a_(&picture.add("A")) {
  if (scene.mode == hbMode::dvr)
    for (std::size_t c = 0; c < 3; ++c) rgb_[c] = &picture.add(std::string(1, "RGB"[c]));
  if (scene.mode != hbMode::iso) return;
  z_ = &picture.add("Z", kInfinity);
  nx_ = &picture.add("N.X");
  ny_ = &picture.add("N.Y");
  nz_ = &picture.add("N.Z");
  value_ = &picture.add("value");
}

double hbPixelWarp::bytes(const hbShearFactorisation& rays, hbMode mode) {
  return mode == hbMode::iso ? double(sizeof(Hit)) * rays.u().count * rays.v().count : 0.0;
}

template <class Blend, class Alone>
void hbPixelWarp::blendPixels(const hbShearFactorisation& rays, Blend blend, Alone alone) const {
  hb::parallelFor((scene_.height + kRows - 1) / kRows, [&](std::int64_t task) {
    Lonely lonely;
    hbPointBatch middles;
    for (int y = int(task) * kRows; y < std::min(scene_.height, (int(task) + 1) * kRows); ++y)
      for (int x = 0; x < scene_.width; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        if (!rays.owns(px, py)) continue;
        const auto in = rays_.clip(px, py);
        if (!in) continue;
        const std::size_t pixel = std::size_t(x) + std::size_t(scene_.width) * std::size_t(y);
        const double length = (in->leave - in->enter) * rays_.stretch(px, py);
        if (blend(pixel, rays.neighbours(px, py), length)) continue;
        lonely.pixels.push_back(pixel);
        lonely.lengths.push_back(length);
        lonely.middles.push_back(rays_.origin(px, py) + 0.5 * (in->enter + in->leave) * rays_.direction(px, py));
        middles.add(lonely.middles.back());
      }
    middles.evaluate(field_, component_);
    lonely.values.swap(middles.value);
    alone(lonely);
  });
}

void hbPixelWarp::values(const hbShearFactorisation& rays, std::span<const double> image) {
  const hbValueMap map = field_.valueMap();
  const bool isXray = scene_.mode == hbMode::xray;
  const auto put = [&](std::size_t pixel, double value, double length) {
    (*y_)[pixel] = float(isXray ? map.toTrue(value) * length : map.toTrue(value));
    (*a_)[pixel] = 1.0F;
  };
  const auto blend = [&](std::size_t pixel, const hbShearFactorisation::Neighbours& around, double length) {
    double sum = 0.0, weights = 0.0;
    for (int k = 0; k < around.count; ++k) {
      const double value = image[around.at[std::size_t(k)]], weight = around.weight[std::size_t(k)];
      if (std::isnan(value)) continue;
      sum += weight * value;
      weights += weight;
    }
    if (weights > 0.0) put(pixel, sum / weights, length);
    return weights > 0.0;
  };
  blendPixels(rays, blend, [&](const Lonely& lonely) {
    for (std::size_t i = 0; i < lonely.pixels.size(); ++i) put(lonely.pixels[i], lonely.values[i], lonely.lengths[i]);
  });
}

void hbPixelWarp::light(const hbShearFactorisation& rays, std::span<const glm::vec4> image, const hbMatter& matter) {
  const auto blend = [&](std::size_t pixel, const hbShearFactorisation::Neighbours& around, double length) {
    glm::dvec3 colour(0.0);
    double opacity = 0.0, weights = 0.0;
    for (int k = 0; k < around.count; ++k) {
      const glm::vec4& ofRay = image[around.at[std::size_t(k)]];
      const double weight = around.weight[std::size_t(k)];
      if (std::isnan(ofRay.a)) continue;
      hbEmissionAbsorption seen; // what the ray would show over the pixel's own length
      seen.add(ofRay, length);
      colour += weight * seen.colour();
      opacity += weight * seen.opacity();
      weights += weight;
    }
    if (weights > 0.0) show(pixel, colour / weights, opacity / weights);
    return weights > 0.0;
  };
  blendPixels(rays, blend, [&](const Lonely& lonely) { showAlone(lonely, matter); });
}

void hbPixelWarp::showAlone(const Lonely& lonely, const hbMatter& matter) {
  if (lonely.pixels.empty()) return;
  hbScene scene = scene_;
  scene.component = component_;
  hbMatterRay ray(field_, scene, matter);
  const auto width = std::size_t(scene_.width);
  for (std::size_t i = 0; i < lonely.pixels.size(); ++i) {
    const std::size_t pixel = lonely.pixels[i];
    const float value = lonely.values[i];
    const hbRay seen =
        scene_.camera->ray(double(pixel % width) + 0.5, double(pixel / width) + 0.5, scene_.width, scene_.height);
    ray.begin(seen, {lonely.middles[i], glm::dvec3(0.0), 0.0, lonely.lengths[i]});
    ray.add(matter.piece(value), lonely.lengths[i], 0.0);
    const hbEmissionAbsorption& light = ray.finish();
    show(pixel, light.colour(), light.opacity());
  }
}

void hbPixelWarp::show(std::size_t pixel, const glm::dvec3& colour, double opacity) {
  for (std::size_t c = 0; c < 3; ++c) (*rgb_[c])[pixel] = float(colour[int(c)]);
  (*y_)[pixel] = float(hb::linearToXyz(colour).y);
  (*a_)[pixel] = float(opacity);
}

std::vector<hbPixelWarp::Hit> hbPixelWarp::shade(const hbShearFactorisation& rays,
                                                 std::span<const double> crossings) const {
  const auto columns = std::size_t(rays.u().count);
  std::vector<Hit> hits(crossings.size(), Hit{kInfinity, 0.0F, {}});
  const glm::dmat3 toWorld(field_.geometry().cubeToWorld());
  const hbValueMap map = field_.valueMap();
  hb::parallelFor((rays.v().count + kRows - 1) / kRows, [&](std::int64_t task) {
    std::vector<std::size_t> found;
    std::vector<glm::dvec3> places, directions;
    const std::size_t end = std::min(crossings.size(), columns * std::size_t((task + 1) * kRows));
    for (std::size_t at = columns * std::size_t(task * kRows); at < end; ++at) {
      if (!(crossings[at] < double(kInfinity))) continue;
      const double a = rays.u().at(int(at % columns)), b = rays.v().at(int(at / columns));
      const int n = std::min(int(crossings[at]), rays.slices() - 2);
      const glm::dvec3 from = rays.point(rays.slice(n), a, b), to = rays.point(rays.slice(n + 1), a, b);
      found.push_back(at);
      places.push_back(from + (crossings[at] - n) * (to - from));
      directions.push_back(glm::normalize(toWorld * (to - from)));
    }
    if (found.empty()) return;
    hbSurfaceShader shader(field_, component_);
    shader.shade(places, directions);
    for (std::size_t i = 0; i < found.size(); ++i)
      hits[found[i]] = {float(rays_.distance(places[i])), float(map.toTrue(shader.values()[i])),
                        glm::vec3(shader.normals()[i])};
  });
  return hits;
}

void hbPixelWarp::surface(const hbShearFactorisation& rays, std::span<const double> crossings) {
  const std::vector<Hit> hits = shade(rays, crossings);
  hb::parallelFor((scene_.height + kRows - 1) / kRows, [&](std::int64_t task) {
    for (int y = int(task) * kRows; y < std::min(scene_.height, (int(task) + 1) * kRows); ++y)
      for (int x = 0; x < scene_.width; ++x)
        if (rays.owns(x + 0.5, y + 0.5) && rays_.clip(x + 0.5, y + 0.5)) put(x, y, rays, hits);
  });
}

void hbPixelWarp::put(int x, int y, const hbShearFactorisation& rays, std::span<const Hit> hits) {
  const double px = x + 0.5, py = y + 0.5;
  const hbShearFactorisation::Neighbours around = rays.neighbours(px, py);
  double covered = 0.0, heaviest = 0.0, depth = 0.0;
  for (int k = 0; k < around.count; ++k) {
    const Hit& hit = hits[around.at[std::size_t(k)]];
    const double weight = around.weight[std::size_t(k)];
    if (!(hit.z < kInfinity)) continue;
    covered += weight;
    if (weight > heaviest) {
      heaviest = weight;
      depth = hit.z;
    }
  }
  if (!(covered >= 0.5)) return;
  // Rays that see another surface, far before or behind that of the nearest ray, would make up one between the two.
  const double apart = hbShearWarp::kSameSurface * std::max(step_, rays_.pixelSize(depth));
  double weights = 0.0, z = 0.0, value = 0.0;
  glm::dvec3 normal(0.0);
  for (int k = 0; k < around.count; ++k) {
    const Hit& hit = hits[around.at[std::size_t(k)]];
    const double weight = around.weight[std::size_t(k)];
    if (!(std::abs(hit.z - depth) <= apart)) continue;
    weights += weight;
    z += weight * hit.z;
    value += weight * hit.value;
    normal += weight * glm::dvec3(hit.normal);
  }
  const glm::dvec3 ray = rays_.camera().ray(px, py, scene_.width, scene_.height).direction;
  const double length = glm::length(normal);
  normal = length > 0.0 ? normal / length : -ray;
  const std::size_t pixel = std::size_t(x) + std::size_t(scene_.width) * std::size_t(y);
  (*y_)[pixel] = float(std::clamp(-glm::dot(normal, ray), 0.0, 1.0)); // Lambert, lit from the viewer
  (*a_)[pixel] = 1.0F;
  (*z_)[pixel] = float(z / weights);
  (*nx_)[pixel] = float(normal.x);
  (*ny_)[pixel] = float(normal.y);
  (*nz_)[pixel] = float(normal.z);
  (*value_)[pixel] = float(value / weights);
}
