#include "report/hbHardCasePicture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <glm/geometric.hpp>

#include "glcombine/hbOglFused.h"
#include "glcombine/hbOglPointBounds.h"
#include "glcombine/hbOglRaycaster.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "raycast/hbRaycaster.h"
#include "raycast/hbShearReference.h"
#include "raycast/hbShearWarp.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "sparsegrid/hbSemiNodalGrid.h"

namespace {

using Engine = hbHardCaseWay::Engine;
constexpr double kUnit = 0x1p-24;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of what is kept in a picture: rounded to floats, and before that in 64 bits.
constexpr double kKept = 0x1p-23;

/// How far samples must be off for the first surface along a ray to be at this place among them; nowhere: none.
class IsoResidual {
public:
  IsoResidual(std::vector<double> values, double iso) : values_(std::move(values)) {
    for (double& value : values_) value -= iso;
  }

  /// All are made to lie on one side.
  double nowhere() const { return toOneSide(values_.size()); }

  double at(double place) const {
    double best = std::numeric_limits<double>::infinity();
    // A place at a sample may have been found from either side of it.
    for (const double lower : {std::floor(place) - 1.0, std::floor(place), std::floor(place) + 1.0}) {
      const double t = place - lower;
      if (lower < 0.0 || lower + 1.0 >= double(values_.size()) || t < -kSlack || t > 1.0 + kSlack) continue;
      const auto k = std::size_t(lower);
      const double a = values_[k], b = values_[k + 1];
      // Both ends moved alike put the crossing there; those before must lie on the first one's side.
      const double here = std::abs(a + t * (b - a));
      const double before = a > b ? toAbove(k) : a < b ? toBelow(k) : toOneSide(k);
      best = std::min(best, std::max(here, before));
    }
    return best;
  }

  /// The greatest step between two samples beside a place.
  double step(double place) const {
    double most = 0.0;
    for (std::size_t k = 0; k + 1 < values_.size(); ++k)
      if (std::abs(double(k) + 0.5 - place) < 2.0) most = std::max(most, std::abs(values_[k + 1] - values_[k]));
    return most;
  }

private:
  static constexpr double kSlack = 1e-3; ///< Of a step: places are rounded by far less.

  double toAbove(std::size_t count) const {
    double most = 0.0;
    for (std::size_t i = 0; i < count; ++i) most = std::max(most, -values_[i]);
    return most;
  }
  double toBelow(std::size_t count) const {
    double most = 0.0;
    for (std::size_t i = 0; i < count; ++i) most = std::max(most, values_[i]);
    return most;
  }
  double toOneSide(std::size_t count) const { return std::min(toAbove(count), toBelow(count)); }

  std::vector<double> values_; ///< Less the iso-value.
};

} // namespace

hbHardCasePicture::hbHardCasePicture(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated)
    : hbHardCaseMeasurement(problem, evaluated), combination_(problem.grid), bounds_(problem.grid, combination_),
      rays_(problem.grid, *problem.scene), slopes_(hb::slopeBounds(problem.grid)),
      reach_(hbOglRoundingBounds(combination_, rays_).reach()) {
  for (std::size_t pixel = 0; pixel < rays_.rays().size(); ++pixel) {
    const hbPlaneRays::Ray& ray = rays_.rays()[pixel];
    std::vector<Sample>& along = samples_.emplace_back();
    for (int i = ray.first; i <= ray.last; ++i) {
      const glm::dvec3 point = glm::clamp(rays_.at(pixel, i), 0.0, 1.0);
      along.push_back({point, problem.grid.calcValue(point, 0)});
    }
  }
}

/// The least and the greatest sample.
std::pair<double, double> hbHardCasePicture::extremes() const {
  double least = kInfinity, greatest = -kInfinity;
  for (const std::vector<Sample>& along : samples_)
    for (const Sample& sample : along) {
      least = std::min(least, sample.value);
      greatest = std::max(greatest, sample.value);
    }
  return {least, greatest};
}

double hbHardCasePicture::range() const {
  if (problem_.scene->mode == hbMode::iso) return std::apply(rangeOf, extremes());
  double greatest = 0.0;
  for (std::size_t pixel = 0; pixel < samples_.size(); ++pixel) {
    double sum = 0.0;
    for (const Sample& sample : samples_[pixel]) sum += weight(pixel) * std::abs(sample.value);
    greatest = std::max(greatest, sum);
  }
  return greatest;
}

hbHardCaseMeasurement::Amplification hbHardCasePicture::amplification() const {
  Amplification most;
  for (const std::vector<Sample>& along : samples_)
    for (const Sample& sample : along) {
      double sum = 0.0;
      for (const hbComponentValue& one : hb::componentValues(combination_, sample.point))
        sum += std::abs(one.grid->coefficient * one.value);
      most.combination = std::max(most.combination, sum);
      most.hierarchical = std::max(most.hierarchical, bounds_.magnitudes(sample.point).weighted);
    }
  const auto [least, greatest] = extremes();
  const double range = rangeOf(least, greatest);
  return {most.hierarchical / range, most.combination / range};
}

hbPicture hbHardCasePicture::drawn(const hbHardCaseWay& way, const hbGlContext* context) const {
  const hbScene& scene = *problem_.scene;
  hbOglRaycaster::Options options;
  switch (way.engine) {
  case Engine::stored:
  case Engine::direct:
    return hbRaycaster(evaluated_, scene).render();
  case Engine::seminodal:
    return hbRaycaster(hbSemiNodalGrid(evaluated_), scene).render();
  case Engine::combination:
    return hbRaycaster(hbCombinationSparseGrid(evaluated_), scene).render();
  case Engine::lattice:
    return hbShearWarp(evaluated_, scene, {}).render();
  case Engine::blend:
    options.form = hbOglRaycaster::Form::blend;
    options.blend.textures = options.blend.target = way.format;
    options.blend.filter = hbOglSparseGrid::Filter::exact;
    break;
  case Engine::fused:
    options.form = hbOglRaycaster::Form::fused;
    break;
  case Engine::oglSeminodal:
    options.form = hbOglRaycaster::Form::seminodal;
    break;
  }
  return hbOglRaycaster(*context, evaluated_, scene, options).render();
}

double hbHardCasePicture::boundAt(const hbHardCaseWay& way, const hbOglPointBounds& device, const glm::dvec3& point,
                                  const glm::dvec3& off) const {
  // Where 32-bit points are, which is taken for a move of the point, as slopes have it.
  const glm::dvec3 there(glm::vec3{point});
  const double moved = glm::dot(slopes_, kUnit * point);
  switch (way.engine) {
  case Engine::direct:
    return bounds_.direct(there) + moved;
  case Engine::seminodal:
    return bounds_.semiNodal(there) + moved;
  case Engine::combination:
    return bounds_.combination(there) + moved;
  case Engine::lattice:
    return bounds_.lattice(point);
  case Engine::blend:
    return device.blend(point, way.format, glm::dvec3(hbOglRoundingBounds::kCoordinate * reach_));
  case Engine::fused:
    return device.fused(there, off + kUnit * point);
  case Engine::oglSeminodal:
    return device.semiNodal(there, off + kUnit * point);
  case Engine::stored:
    break;
  }
  return bounds_.stored(point);
}

/// Of hbOglRays' pointOfRay(): of each product of uniforms, place and pixel 6 are rounded at the most: the uniform, two
/// products, the sum inside and the two outside.
glm::dvec3 hbHardCasePicture::shaderOff(std::size_t pixel, int plane) const {
  const hbPlaneRays::Plane first = rays_.plane(0), last = rays_.plane(rays_.planes() - 1);
  const auto width = std::size_t(problem_.scene->width);
  const std::size_t column = pixel % width, row = pixel / width;
  const double x = double(column) + 0.5, y = double(row) + 0.5;
  const double part = double(plane) / std::max(1, rays_.planes() - 1);
  const auto magnitude = [&](const glm::dvec3& a, const glm::dvec3& b) { return glm::abs(a) + part * glm::abs(b - a); };
  return 6.0 * kUnit *
         (magnitude(first.corner, last.corner) + x * magnitude(first.right, last.right) +
          y * magnitude(first.down, last.down));
}

std::vector<std::vector<double>> hbHardCasePicture::sampleBounds(const hbHardCaseWay& way) const {
  const hbOglPointBounds device(bounds_);
  std::vector<std::vector<double>> list(samples_.size());
  for (std::size_t pixel = 0; pixel < samples_.size(); ++pixel)
    for (std::size_t i = 0; i < samples_[pixel].size(); ++i)
      list[pixel].push_back(
          boundAt(way, device, samples_[pixel][i].point, shaderOff(pixel, rays_.rays()[pixel].first + int(i))));
  return list;
}

/// Of adding up numbers in 32 bits: in the shader in blocks, in a target one by one.
double hbHardCasePicture::sumBound(const hbHardCaseWay& way, double samples, double magnitude) {
  if (way.engine == Engine::blend) return samples * kUnit * magnitude;
  if (way.isOpenGl()) return (hbOglFused::kBlock + samples / hbOglFused::kBlock + 2.0) * kUnit * magnitude;
  return 0.0;
}

std::vector<hbHardCaseError> hbHardCasePicture::xrayErrors(const hbHardCaseWay& way, const hbPicture& picture) const {
  const std::vector<float>&ys = *picture.find("Y"), &covered = *picture.find("A");
  const std::vector<std::vector<double>> bounds = sampleBounds(way);
  const double zero = way.engine == Engine::blend ? hbOglPointBounds(bounds_).zero(way.format) : 0.0;
  std::vector<hbHardCaseError> list;
  for (std::size_t pixel = 0; pixel < samples_.size(); ++pixel) {
    if (samples_[pixel].empty()) { // By planes, a ray that meets none shows nothing, in the volume or beside it.
      list.push_back({ys[pixel] == 0.0F && covered[pixel] == 0.0F ? 0.0 : kInfinity, 0.0});
      continue;
    }
    double sum = 0.0, bound = 0.0, magnitude = 0.0;
    for (std::size_t i = 0; i < samples_[pixel].size(); ++i) {
      sum += samples_[pixel][i].value;
      bound += bounds[pixel][i];
      magnitude += std::abs(samples_[pixel][i].value - zero) + bounds[pixel][i];
    }
    bound += sumBound(way, double(samples_[pixel].size()), magnitude);
    const double expected = weight(pixel) * sum;
    const double error = covered[pixel] == 1.0F ? std::abs(double(ys[pixel]) - expected) : kInfinity;
    list.push_back({error, weight(pixel) * bound + kKept * std::abs(expected)});
  }
  return list;
}

/// Pixels blend the rays around theirs, whose places in the picture are known to 1e-9 of a step in 64 bits.
std::vector<hbHardCaseError> hbHardCasePicture::shearErrors(const hbPicture& picture) const {
  constexpr double kBlend = 4e-9;
  const hbScene& scene = *problem_.scene;
  const std::vector<float>&ys = *picture.find("Y"), &covered = *picture.find("A");
  hbShearReference reference(problem_.grid, scene);
  std::vector<hbHardCaseError> list;
  for (std::size_t pixel = 0; pixel < ys.size(); ++pixel) {
    const std::size_t column = pixel % std::size_t(scene.width), row = pixel / std::size_t(scene.width);
    const double x = double(column) + 0.5, y = double(row) + 0.5;
    const auto segment = hb::clipToCube(scene.camera->ray(x, y, scene.width, scene.height), rays_.worldToCube());
    if (!segment) continue;
    double sum = 0.0, weights = 0.0, largest = 0.0, bound = reference.rounding();
    for (const hbShearReference::Neighbour& one : reference.neighbours(x, y)) {
      const hbShearReference::Samples& samples = reference.samples(*one.rays, one.i, one.j);
      if (samples.values.empty()) continue;
      const double mean = samples.mean();
      sum += one.weight * mean;
      weights += one.weight;
      largest = std::max(largest, std::abs(mean));
    }
    const double length = segment->length();
    double expected = length * sum / weights;
    if (!(weights > 0.0)) { // no slice is met: the value in the middle stands in, at a point of 32 bits
      const glm::dvec3 middle = segment->at(segment->enter + 0.5 * length);
      expected = length * reference.value(middle);
      bound += glm::dot(slopes_, kUnit * glm::abs(middle));
    }
    const double error = covered[pixel] == 1.0F ? std::abs(double(ys[pixel]) - expected) : kInfinity;
    list.push_back({error, length * (bound + kBlend * largest) + kKept * std::abs(expected)});
  }
  return list;
}

std::vector<hbHardCaseError> hbHardCasePicture::isoErrors(const hbHardCaseWay& way, const hbPicture& picture) const {
  const hbScene& scene = *problem_.scene;
  const std::vector<float>&depths = *picture.find("Z"), &covered = *picture.find("A");
  const std::vector<std::vector<double>> bounds = sampleBounds(way);
  const double near = hbSampling::extent(problem_.grid.geometry(), *scene.camera).near, iso = *scene.isoValue;
  const double zero = way.engine == Engine::blend ? hbOglPointBounds(bounds_).zero(way.format) : 0.0;
  std::vector<hbHardCaseError> list;
  for (std::size_t pixel = 0; pixel < samples_.size(); ++pixel) {
    if (samples_[pixel].empty()) continue;
    std::vector<double> values;
    for (const Sample& sample : samples_[pixel]) values.push_back(sample.value);
    const IsoResidual residual(std::move(values), iso);
    // The iso-value is rounded, too, and where numbers stand for values so is its number.
    const double bound =
        *std::max_element(bounds[pixel].begin(), bounds[pixel].end()) + 4.0 * kUnit * (std::abs(iso) + std::abs(zero));
    if (covered[pixel] == 0.0F) {
      list.push_back({residual.nowhere(), bound});
      continue;
    }
    const double depth = double(depths[pixel]);
    const double place = (depth - near) / rays_.step() - 0.5 - rays_.rays()[pixel].first;
    // In steps: (iso - a) / (b - a) is rounded four times and adds to a plane's index; the depth is kept in 32 bits.
    const double moved = (8.0 + rays_.planes()) * kUnit + kKept * std::abs(depth) / rays_.step();
    list.push_back({residual.at(place), bound + moved * residual.step(place)});
  }
  return list;
}

std::vector<hbHardCaseError> hbHardCasePicture::storedErrors() const {
  const double scale = problem_.lost.valueMap().scale;
  std::vector<hbHardCaseError> list;
  for (std::size_t pixel = 0; pixel < samples_.size(); ++pixel) {
    if (samples_[pixel].empty()) continue;
    double sum = 0.0, bounds = 0.0;
    for (const Sample& sample : samples_[pixel]) {
      sum += scale * problem_.lost.calcValue(sample.point, 0);
      bounds += bounds_.stored(sample.point);
    }
    // An iso-surface moves with single values: the mean of them.
    const double each = problem_.scene->mode == hbMode::xray ? weight(pixel) : 1.0 / double(samples_[pixel].size());
    list.push_back({each * std::abs(sum), each * bounds});
  }
  return list;
}

std::vector<hbHardCaseError> hbHardCasePicture::errors(const hbHardCaseWay& way, const hbGlContext* context) const {
  if (way.engine == Engine::stored) return storedErrors();
  const hbPicture picture = drawn(way, context);
  if (problem_.scene->mode == hbMode::iso) return isoErrors(way, picture);
  return way.engine == Engine::lattice ? shearErrors(picture) : xrayErrors(way, picture);
}
