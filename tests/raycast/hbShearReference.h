#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "raycast/hbShearFactorisation.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "sparsegrid/hbSparseGrid.h"

/// Shear-warp written down plainly: one ray, one slice, one point after the other, in 64 bits.
class hbShearReference {
public:
  /// Slices that a ray meets in what is seen of the cube and before the camera, and the field's value on each.
  struct Samples {
    int first = 0;
    std::vector<double> values;
    double before = 0.0, after = 0.0; ///< What the ray goes on in there before and after them, in slabs.

    /// The mean along the ray: a value stands for half a slab to either side, or for what there is.
    double mean() const {
      double sum = 0.0, weights = 0.0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        const double weight = (k == 0 ? before : 0.5) + (k + 1 == values.size() ? after : 0.5);
        sum += weight * values[k];
        weights += weight;
      }
      return sum / weights;
    }
  };
  /// An intermediate ray beside a pixel's ray.
  struct Neighbour {
    const hbShearFactorisation* rays;
    int i, j;
    double weight;
  };

  hbShearReference(const hbSparseGrid& grid, const hbScene& scene, int supersample = 1)
      : grid_(grid), scene_(withCamera(grid, scene)),
        rays_(*scene_.camera, scene_.width, scene_.height, grid.geometry(), box()),
        list_(hbShearFactorisation::of(scene_, grid.geometry(), rays_, supersample)) {}

  const hbScene& scene() const { return scene_; }
  hbScene::ClipBox box() const { return scene_.clip.value_or(hbScene::ClipBox{}); }
  const hbPixelRays& rays() const { return rays_; }
  const std::vector<hbShearFactorisation>& factorisations() const { return list_; }

  /// The field in true values: the component, or the length of the vector.
  double value(const glm::dvec3& point) const {
    const hbValueMap map = grid_.valueMap();
    if (!scene_.magnitude) return map.toTrue(grid_.calcValue(point, scene_.component));
    double sum = 0.0;
    for (int c = 0; c < grid_.components(); ++c) sum += std::pow(map.toTrue(grid_.calcValue(point, c)), 2);
    return std::sqrt(sum);
  }

  /// The rays around a pixel's, found by bisection, with their bilinear weights.
  std::vector<Neighbour> neighbours(double px, double py) const {
    std::vector<Neighbour> found;
    for (const hbShearFactorisation& f : list_) {
      if (!f.owns(px, py)) continue;
      const glm::dvec2 base = f.base(px, py);
      for (const auto& [i, wu] : beside(f.u(), base.x))
        for (const auto& [j, wv] : beside(f.v(), base.y)) found.push_back({&f, i, j, wu * wv});
    }
    return found;
  }

  const Samples& samples(const hbShearFactorisation& f, int i, int j) {
    const auto [known, isNew] = samples_.try_emplace({&f, i, j});
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

  /// The way of a ray from slice n, which may lie in the eye, to the next.
  glm::dvec3 slabOf(const hbShearFactorisation& f, int i, int j, int n) const {
    const glm::dvec3 p = point(f, i, j, n + 1);
    const glm::dvec3 way = scene_.camera->projection == hbCamera::Projection::perspective ? p - rays_.origin(0.0, 0.0)
                                                                                          : rays_.direction(0.0, 0.0);
    return way / (std::abs(way[f.order().plane]) * f.slices());
  }

  static glm::dvec3 point(const hbShearFactorisation& f, int i, int j, int n) {
    return f.point(f.slice(n), f.u().at(i), f.v().at(j));
  }

  /// The slopes of the field: no two values differ by more than the sum of slope times distance along the axes. A hat
  /// of level l rises by 2^l, the two of level 0 by one each.
  glm::dvec3 slopes() const {
    glm::dvec3 sum(0.0);
    for (const hbSubspace& subspace : grid_.indexSet().subspaces()) {
      float largest = 0.0F;
      for (const float s : grid_.surpluses(subspace, scene_.component)) largest = std::max(largest, std::abs(s));
      for (int d = 0; d < 3; ++d)
        if (!grid_.indexSet().flat()[d])
          sum[d] += (subspace.levels[d] == 0 ? 2.0 : std::exp2(subspace.levels[d])) * largest;
    }
    return sum * grid_.latticeScale() * grid_.valueMap().scale;
  }

  /// Rounding of a value on a slice, whichever axis its rows follow.
  double rounding() const {
    double sum = 0.0;
    for (int c = 0; c < grid_.components(); ++c)
      sum += std::max({hb::latticeBound(grid_, 0, c), hb::latticeBound(grid_, 1, c), hb::latticeBound(grid_, 2, c)});
    return sum * grid_.valueMap().scale;
  }

private:
  static hbScene withCamera(const hbSparseGrid& grid, hbScene scene) {
    scene.camera = scene.cameraFor(grid.geometry());
    return scene;
  }

  /// Indices and weights along one axis; those outside are left out.
  static std::vector<std::pair<int, double>> beside(const hbShearFactorisation::Axis& axis, double coordinate) {
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

  struct Key {
    const hbShearFactorisation* rays;
    int i, j;
    auto operator<=>(const Key&) const = default;
  };

  const hbSparseGrid& grid_;
  hbScene scene_;
  hbPixelRays rays_;
  std::vector<hbShearFactorisation> list_;
  std::map<Key, Samples> samples_;
};
