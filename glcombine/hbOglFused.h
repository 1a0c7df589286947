#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglLight.h"
#include "glcombine/hbOglMatter.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglValues.h"

/// Planewise ray casting in one draw a picture: a fragment shader walks along its pixel's ray and evaluates the whole
/// sparse grid at every sample (hbOglValues), where hbOglSparseGrid draws every component grid on every plane. Where
/// that takes more turns than hbGlProgram::kMostTurns, planes are drawn in several passes, each of which goes on from
/// what the pass before has found: pictures are the same to the bit.
///
/// What is found is hbPlaneCompositor's, in 32 bits. The context must be current wherever it is used, its end included.
class hbOglFused {
public:
  /// Keep a reference to `context`. Throw hbError as hbOglValues does.
  hbOglFused(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component);
  hbOglFused(const hbGlContext& context, const hbSemiNodalGrid& grid, int component);

  /// Draws into `out`, of one channel r32f and the picture's size. X-ray: the sum of the values on the ray's planes, 0
  /// without any; added up in blocks of kBlock, so that n values are rounded kBlock + n / kBlock times. MIP: the
  /// greatest value, or kLeast. Iso: the place of the first crossing, as hbPlaneCompositor has it, or
  /// hbOglRays::kNowhere. A mode's shader is compiled when it is first asked for.
  void march(const hbOglRays& rays, const hbGlTarget& out) const;

  /// DVR: draws into `out`, of four channels, what hbPlaneRays::dvr() takes; 0 for rays that meet no plane. A ray ends
  /// where nothing behind would show. `matter` is that of field values; `light` is looked at where it is lit.
  void composite(const hbOglRays& rays, const hbOglMatter& matter, const hbOglLight& light,
                 const hbGlTarget& out) const;

  /// Draws into `out`, of four channels, for each pixel whose place in `places` (as march() draws it) is not
  /// hbOglRays::kNowhere the value there and its central differences in cube units as hbSurfaceShader takes them, 0
  /// along flat axes; for the others 0. Seven evaluations a pixel.
  void differences(const hbOglRays& rays, const hbGlTarget& places, const hbGlTarget& out) const;

  static constexpr int kBlock = 16;
  static constexpr float kLeast = std::numeric_limits<float>::lowest();

  /// Of the values.
  std::int64_t textureBytes() const { return values_.textureBytes(); }

private:
  int planesAPass(int turnsAPlane) const;
  void draw(const hbGlProgram& program, int planes, int aPass, const hbGlTarget& out) const;
  const hbGlProgram& prepared(std::unique_ptr<hbGlProgram>& program, const std::string& shader, const hbOglRays& rays,
                              const hbGlTarget& out) const;

  const hbGlFunctions& gl_;
  hbOglValues values_;
  hbGlQuad quad_;
  mutable std::array<std::unique_ptr<hbGlProgram>, 3> march_;     ///< One a mode.
  mutable std::array<std::unique_ptr<hbGlProgram>, 4> composite_; ///< Of samples, of slabs; lit.
  mutable std::unique_ptr<hbGlProgram> differences_;
};
