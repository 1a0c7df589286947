#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "raycast/hbShearFactorisation.h"
#include "sparsegrid/hbSparseGrid.h"

/// Shear-warp written down plainly: one ray, one slice, one point after the other, in 64 bits. What hbShearWarp is held
/// against; slow.
class hbShearReference {
public:
  /// Slices that a ray meets in what is seen of the cube and before the camera, and the field's value on each.
  struct Samples {
    int first = 0;
    std::vector<double> values;
    double before = 0.0, after = 0.0; ///< What the ray goes on in there before and after them, in slabs.

    /// The mean along the ray: a value stands for half a slab to either side, or for what there is.
    double mean() const;
  };
  /// An intermediate ray beside a pixel's ray.
  struct Neighbour {
    const hbShearFactorisation* rays;
    int i, j;
    double weight;
  };

  /// Keeps a reference to `grid`. Throws hbError for a camera that is not valid.
  hbShearReference(const hbSparseGrid& grid, const hbScene& scene, int supersample = 1);
  hbShearReference(const hbShearReference&) = delete;
  hbShearReference& operator=(const hbShearReference&) = delete;

  /// With its camera.
  const hbScene& scene() const { return scene_; }
  hbScene::ClipBox box() const { return scene_.clip.value_or(hbScene::ClipBox{}); }
  const hbPixelRays& rays() const { return rays_; }
  const std::vector<hbShearFactorisation>& factorisations() const { return list_; }

  /// The field in true values: the component, or the length of the vector.
  double value(const glm::dvec3& point) const;

  /// The rays around a pixel's, found by bisection, with their bilinear weights.
  std::vector<Neighbour> neighbours(double px, double py) const;

  /// Evaluated when they are first asked for.
  const Samples& samples(const hbShearFactorisation& f, int i, int j);

  /// The way of a ray from slice n, which may lie in the eye, to the next.
  glm::dvec3 slabOf(const hbShearFactorisation& f, int i, int j, int n) const;

  static glm::dvec3 point(const hbShearFactorisation& f, int i, int j, int n) {
    return f.point(f.slice(n), f.u().at(i), f.v().at(j));
  }

  /// The slopes of the field in true values: no two values differ by more than the sum of slope times distance along
  /// the axes.
  glm::dvec3 slopes() const;

  /// Rounding of a true value on a slice, whichever axis its rows follow.
  double rounding() const;

private:
  using Key = std::tuple<const hbShearFactorisation*, int, int>;

  const hbSparseGrid& grid_;
  hbScene scene_;
  hbPixelRays rays_;
  std::vector<hbShearFactorisation> list_;
  std::map<Key, Samples> samples_;
};
