#pragma once

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "raycast/hbPixelRays.h"
#include "scene/hbScene.h"
#include "sparsegrid/hbAxisOrder.h"

/// The geometry of a picture's rays along one main direction of a volume's cube: slices across it, and rays through a
/// rectilinear lattice that stays one in every slice. Of both, what lies in the box that is seen (hbPixelRays::box());
/// slices lie where they do for the whole cube.
///
/// With w the axis of the main direction and u, v the other two, a ray has base coordinates (a, b) that do not change
/// along it. Orthographic: u and v where w = 1/2. Perspective: its slopes du/|dw| and dv/|dw|. In a slice it lies at
/// u = offsetU + scale a and v = offsetV + scale b. The intermediate rays are those of a row of a and a
/// row of b.
///
/// Source: Lacroute, Levoy, Fast Volume Rendering Using a Shear-Warp Factorization of the Viewing Transformation.
class hbShearFactorisation {
public:
  /// Slopes du/dw in the world up to which rays keep the main direction of the view axis.
  static constexpr double kSteepest = 2.0;

  /// Increasing base coordinates, those of 0 <= i < count: equal steps, or steps that are equal once projected.
  struct Axis {
    double first = 0.0, step = 1.0;
    double bend = 0.0; ///< 1 + bend i is positive.
    int count = 0;

    double at(int i) const { return first + i * step / (1.0 + bend * i); }
    /// Where a coordinate lies among them: at(i) is at i.
    double place(double coordinate) const {
      const double beyond = coordinate - first;
      return beyond / (step - bend * beyond);
    }
    /// The same row from another place on, between two of them perhaps.
    Axis from(double place, int newCount) const;
  };

  /// One slice: where it lies along w, and how base coordinates become those of the cube there.
  struct Slice {
    double w = 0.0, offsetU = 0.0, offsetV = 0.0, scale = 1.0;
  };

  /// What is needed for the picture: one factorisation a main direction; together they own all pixels that see the
  /// volume. Mostly that is the view axis' own; in a perspective picture, pixels whose rays are steeper than kSteepest
  /// to it take the main direction of their own. `scene` has a camera. Intermediate rays are at most 1 / supersample of
  /// a pixel apart in the picture (at the pixels' own rays where there are several directions). O(slices), and
  /// O(pixels) where there are several directions.
  static std::vector<hbShearFactorisation> of(const hbScene& scene, const hbGeometry& geometry, const hbPixelRays& rays,
                                              int supersample);

  /// fast is u, row is v, plane is w: u the first of the two.
  const hbAxisOrder& order() const { return order_; }
  /// The slices, front to back: at the midpoints of slices() equal slabs of the cube. Those from firstSlice() to before
  /// endSlice() lie in the box, and in front of a perspective camera; none where the two are the same.
  int slices() const { return slices_; }
  int firstSlice() const { return firstSlice_; }
  int endSlice() const { return endSlice_; }
  Slice slice(double n) const; ///< And between two, and beside them.
  /// What a slice differs by from the one before it.
  Slice changeOfSlice() const;
  /// Among the slices: the box's front and back face; half a slab before the first and behind the last one of a cube.
  double frontPlace() const { return placeOf(sign_ > 0.0 ? faces(order_.plane).lo : faces(order_.plane).hi); }
  double backPlace() const { return placeOf(sign_ > 0.0 ? faces(order_.plane).hi : faces(order_.plane).lo); }
  /// Among the slices: a perspective camera's place; that of an orthographic one is far before them.
  double eyePlace() const;
  /// Among the slices: where a ray crosses an orthographic camera's plane.
  double placeInFront(double a, double b) const;
  const Axis& u() const { return u_; }
  const Axis& v() const { return v_; }
  /// Whether no ray meets a slice.
  bool isEmpty() const { return u_.count == 0 || v_.count == 0; }
  /// The box along an axis of the cube.
  struct Faces {
    double lo = 0.0, hi = 1.0;
  };
  Faces faces(int axis) const { return {rays_->box().lo[axis], rays_->box().hi[axis]}; }
  /// Those i (from the first to before the second) whose rays lie between the faces in a slice.
  static std::pair<int, int> inside(const Axis& axis, double offset, double scale, const Faces& faces);

  /// Where the ray of base coordinates (a, b) meets a slice.
  glm::dvec3 point(const Slice& slice, double a, double b) const;
  /// How far along the view axis that is from the camera.
  double distance(int n, double a, double b) const { return rays_->distance(point(slice(n), a, b)); }
  /// The base coordinates of the ray through a point of the picture.
  glm::dvec2 base(double px, double py) const;
  /// The intermediate rays around the ray through a point of the picture, as far as there are any.
  struct Neighbours {
    int count = 0;
    std::array<std::size_t, 4> at{}; ///< i + u().count j
    std::array<double, 4> weight{};  ///< Bilinear, positive; they sum to 1 where no ray is missing.
  };
  Neighbours neighbours(double px, double py) const;
  /// Whether the pixel's ray goes along this main direction.
  bool owns(double px, double py) const { return all_ || directionOf(px, py) == direction_; }
  /// Whether a part of the box lies behind an orthographic camera's plane.
  bool isPartlyBehind() const { return partlyBehind_; }

private:
  static constexpr int kOfTheView = -1;
  /// What the pixels ask for: their base coordinates, the greatest m and the greatest vectors of equalSteps().
  struct Reach {
    glm::dvec2 least{std::numeric_limits<double>::infinity()}, most{-std::numeric_limits<double>::infinity()};
    glm::dvec2 steepest{0.0};
    double nearest = 0.0;
  };

  hbShearFactorisation(const hbScene& scene, const hbGeometry& geometry, const hbPixelRays& rays, int direction);
  /// 2 * axis, one more for the negative direction.
  static int mainDirection(const glm::dvec3& scaled);
  int directionOf(double px, double py) const;
  double placeOf(double w) const { return (sign_ > 0.0 ? w : 1.0 - w) * slices_ - 0.5; }
  void placeSlices(const hbScene& scene, const hbGeometry& geometry);
  /// Takes a pixel among those that the rays must cover.
  void reach(double px, double py);
  /// Lays the rays over them, as far as there are slices.
  void placeRays(int supersample);
  Axis equalSteps(int d, int supersample) const;
  Axis projectedSteps(int d, int supersample) const;
  Axis onPixels(const Axis& axis, int d) const;
  Axis cut(const Axis& axis, bool alongV) const;
  glm::dvec2 gradient(int row) const { return {toBase_[1][row], toBase_[2][row]}; }

  const hbPixelRays* rays_;
  glm::dvec3 edges_;  ///< World lengths of the cube's edges.
  int viewDirection_; ///< That of the view axis.
  int direction_;     ///< This one.
  bool all_ = false;  ///< Whether all pixels have this direction.
  hbAxisOrder order_;
  double sign_ = 1.0; ///< Of the direction along w.
  int slices_ = 1, firstSlice_ = 0, endSlice_ = 1;
  bool perspective_, partlyBehind_ = false;
  glm::dvec3 eye_{0.0};    ///< Perspective.
  glm::dvec2 slope_{0.0};  ///< Orthographic: du/dw, dv/dw.
  glm::dmat3 toBase_{1.0}; ///< (1, px, py) to (a m, b m, m).
  Reach reach_;
  Axis u_, v_;
};
