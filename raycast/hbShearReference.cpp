#include "raycast/hbShearReference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sparsegrid/hbRoundingBounds.h"

namespace {

hbScene withCamera(const hbSparseGrid& grid, hbScene scene) {
  scene.camera = scene.cameraFor(grid.geometry());
  return scene;
}

/// Indices and weights along one axis; those outside are left out.
std::vector<std::pair<int, double>> beside(const hbShearFactorisation::Axis& axis, double coordinate) {
  const auto at = [&](double place) { return axis.first + place * axis.step / (1.0 + axis.bend * place); };
  double lo = -1.0, hi = axis.count;
  if (axis.count == 0 || !(coordinate > at(lo) && coordinate < at(hi))) return {};
  for (int round = 0; round < 80; ++round) (at(0.5 * (lo + hi)) <= coordinate ? lo : hi) = 0.5 * (lo + hi);
  constexpr double kOnRay = 1e-9; // a pixel on a ray but for rounding is on it
  const int lower = int(std::floor(lo + kOnRay));
  const double upper = std::max(0.0, lo - lower);
  std::vector<std::pair<int, double>> found;
  if (lower >= 0 && lower < axis.count) found.emplace_back(lower, 1.0 - upper);
  if (lower + 1 >= 0 && lower + 1 < axis.count && upper >= kOnRay) found.emplace_back(lower + 1, upper);
  return found;
}

} // namespace

double hbShearReference::Samples::mean() const {
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double weight = (k == 0 ? before : 0.5) + (k + 1 == values.size() ? after : 0.5);
    sum += weight * values[k];
    weights += weight;
  }
  return sum / weights;
}

hbShearReference::hbShearReference(const hbSparseGrid& grid, const hbScene& scene, int supersample)
    : grid_(grid), scene_(withCamera(grid, scene)),
      rays_(*scene_.camera, scene_.width, scene_.height, grid.geometry(), box()),
      list_(hbShearFactorisation::of(scene_, grid.geometry(), rays_, supersample)) {}

double hbShearReference::value(const glm::dvec3& point) const {
  const hbValueMap map = grid_.valueMap();
  if (!scene_.magnitude) return map.toTrue(grid_.calcValue(point, scene_.component));
  double sum = 0.0;
  for (int c = 0; c < grid_.components(); ++c) sum += std::pow(map.toTrue(grid_.calcValue(point, c)), 2);
  return std::sqrt(sum);
}

std::vector<hbShearReference::Neighbour> hbShearReference::neighbours(double px, double py) const {
  std::vector<Neighbour> found;
  for (const hbShearFactorisation& f : list_) {
    if (!f.owns(px, py)) continue;
    const glm::dvec2 base = f.base(px, py);
    for (const auto& [i, wu] : beside(f.u(), base.x))
      for (const auto& [j, wv] : beside(f.v(), base.y)) found.push_back({&f, i, j, wu * wv});
  }
  return found;
}

const hbShearReference::Samples& hbShearReference::samples(const hbShearFactorisation& f, int i, int j) {
  const auto [known, isNew] = samples_.try_emplace(Key(&f, i, j));
  if (!isNew) return known->second;
  Samples& result = known->second;
  for (int n = f.firstSlice(); n < f.slices(); ++n) {
    const glm::dvec3 p = point(f, i, j, n);
    if (p != glm::clamp(p, box().lo, box().hi)) continue;
    // Beside a wide picture's edge rays go back from the eye, which has them in front all the same.
    if (scene_.camera->projection == hbCamera::Projection::orthographic && rays_.distance(p) < 0.0) continue;
    if (result.values.empty()) result.first = n;
    result.values.push_back(value(p));
  }
  if (result.values.empty()) return result;
  const glm::dvec3 p = point(f, i, j, result.first), way = slabOf(f, i, j, result.first);
  double before = std::numeric_limits<double>::infinity(), after = before;
  for (int d = 0; d < 3; ++d) {
    if (way[d] == 0.0) continue;
    before = std::min(before, std::max((p[d] - box().lo[d]) / way[d], (p[d] - box().hi[d]) / way[d]));
    after = std::min(after, std::max((box().lo[d] - p[d]) / way[d], (box().hi[d] - p[d]) / way[d]));
  }
  // From the camera, or its plane, on.
  result.before = std::min(before, rays_.distance(p) / (rays_.distance(p + way) - rays_.distance(p)));
  result.after = after - double(result.values.size() - 1);
  return result;
}

glm::dvec3 hbShearReference::slabOf(const hbShearFactorisation& f, int i, int j, int n) const {
  const glm::dvec3 p = point(f, i, j, n + 1);
  const glm::dvec3 way = scene_.camera->projection == hbCamera::Projection::perspective ? p - rays_.origin(0.0, 0.0)
                                                                                        : rays_.direction(0.0, 0.0);
  return way / (std::abs(way[f.order().plane]) * f.slices());
}

glm::dvec3 hbShearReference::slopes() const {
  return hb::slopeBounds(grid_, scene_.component) * grid_.valueMap().scale;
}

double hbShearReference::rounding() const {
  double sum = 0.0;
  for (int c = 0; c < grid_.components(); ++c)
    sum += std::max({hb::latticeBound(grid_, 0, c), hb::latticeBound(grid_, 1, c), hb::latticeBound(grid_, 2, c)});
  return sum * grid_.valueMap().scale;
}
