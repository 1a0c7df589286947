#pragma once

#include <cstddef>
#include <vector>

#include "glcombine/hbGlFormat.h"
#include "sparsegrid/hbPointBounds.h"

/// How far what OpenGL makes of a sparse grid at a point may be from the exact value: the roundings of
/// hbOglRoundingBounds.h, of what is added up there, and those of the formats. In field values.
///
/// Numbers below the least normal one may become 0.
class hbOglPointBounds {
public:
  /// Keeps a reference.
  explicit hbOglPointBounds(const hbPointBounds& bounds);

  /// Of hbOglValues at a point that is known to the device up to `off` in each coordinate of the cube. All component
  /// grids: every addition is rounded as the partial sum is there, in the order of hb::interleaved(). `off` counts with
  /// the greatest slopes there are anywhere.
  double fused(const glm::dvec3& point, const glm::dvec3& off = glm::dvec3(0.0)) const;
  /// The lines of the semi-nodal grid.
  double semiNodal(const glm::dvec3& point, const glm::dvec3& off = glm::dvec3(0.0)) const;

  /// Of hbOglSparseGrid with textures and target of one format, the exact filter, and the order that is chosen where
  /// nobody says one. Rounded are a texel (16-bit floats: towards 0 perhaps; fixed point: to half a step), every term
  /// and every sum in the target (fixed point: either by half a step at the most); what is less than zero() is clamped
  /// to it in fixed point.
  double blend(const glm::dvec3& point, hbGlFormat format, const glm::dvec3& off) const;

  /// What stands for the number 0 in targets of that format: their numbers are those of values less this.
  double zero(hbGlFormat format) const;

private:
  double moved(const hbComponentValue& one, const glm::dvec3& off) const;

  const hbPointBounds& bounds_;
  glm::dvec3 slopes_;
  std::vector<std::size_t> interleaved_;
  double least_ = 0.0, greatest_ = 0.0; ///< Nodal values.
  double whole_ = 0.0, positive_ = 0.0; ///< Sum of the coefficients, and of the positive ones.
};
