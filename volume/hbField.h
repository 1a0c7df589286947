#pragma once

#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

#include "volume/hbGeometry.h"
#include "volume/hbRange.h"
#include "volume/hbValueMap.h"

/// Points of the unit cube as three arrays of one length.
template <class Real>
struct hbPointsOf {
  std::span<const Real> x, y, z;

  std::size_t size() const { return x.size(); }
  hbPointsOf subspan(std::size_t first, std::size_t count) const {
    return {x.subspan(first, count), y.subspan(first, count), z.subspan(first, count)};
  }
};
using hbPoints = hbPointsOf<float>;
using hbPoints64 = hbPointsOf<double>;

/// Gradients as three arrays of one length, in field values per unit of the cube's edge.
template <class Real>
struct hbGradientsOf {
  std::span<Real> dx, dy, dz;
};
using hbGradients = hbGradientsOf<float>;
using hbGradients64 = hbGradientsOf<double>;

/// An axis-aligned box inside the unit cube, lo <= hi, closed.
struct hbBox {
  glm::vec3 lo{0.0F}, hi{1.0F};
};

/// A function on the unit cube with one or more components: what every representation of a volume is to a renderer.
///
/// Values are 32-bit floats in the field's own units; `valueMap()` says what they stand for. Coordinates outside the
/// cube are clamped to it, a NaN coordinate counts as 0. Components run from 0 to components()-1; another one is the
/// caller's bug. Const members may be called from several threads at once.
class hbField {
public:
  virtual ~hbField() = default;

  /// The samples the field stands for: sizes (how fine it is) and the way to world space.
  virtual const hbGeometry& geometry() const = 0;
  virtual int components() const = 0;
  virtual hbValueMap valueMap() const { return {}; }

  /// out[i] = the value of `component` at point i. All spans have the same length.
  virtual void values(const hbPoints& points, int component, std::span<float> out) const = 0;

  /// Values, and the gradient of the interpolant itself: at kinks the one-sided slope towards +, at the cube's upper
  /// faces the one towards -.
  virtual void gradients(const hbPoints& points, int component, std::span<float> out,
                         const hbGradients& gradient) const = 0;

  /// out[x + strideY y + strideZ z] = the value at (xs[x], ys[y], zs[z]); coordinates increase along each axis and are
  /// in 64 bits, so that nodes are hit exactly. Strides are in floats. This default calls values() row by row, at the
  /// coordinates rounded to floats.
  virtual void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs,
                       int component, float* out, std::size_t strideY, std::size_t strideZ) const;

  /// Encloses every value of `component` in `box`: conservative, not always tight.
  virtual hbRange range(const hbBox& box, int component) const = 0;

  /// Whether range() looks at what is in the box and nowhere else: then it is worth while to ask for many small boxes
  /// before a picture is made.
  virtual bool hasLocalRanges() const { return false; }

protected:
  hbField() = default;
  hbField(const hbField&) = default;
  hbField& operator=(const hbField&) = default;
};
