#pragma once

#include <limits>
#include <memory>

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglMatter.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglTiles.h"

/// hbPlaneCompositor on the device: X-ray adds planes up in one float target, MIP keeps the greatest by GL_MAX, and
/// where two consecutive planes lie on either side of the iso-value the nearest place is kept by GL_MIN; DVR goes on,
/// for each lot of planes in another target, from what is seen of those before. The context must be current wherever
/// it is used.
class hbOglPlaneCompositor {
public:
  /// What stands for a MIP's maximum where there is no sample.
  static constexpr float kLeast = std::numeric_limits<float>::lowest();

  /// Keeps references to `gl` and, for DVR, to the `matter` of the numbers in targets; for pictures of the scene's mode
  /// and size.
  hbOglPlaneCompositor(const hbGlFunctions& gl, const hbScene& scene, const hbOglMatter* matter = nullptr);

  /// Begins a picture. `iso`: the iso-value as numbers in targets have it.
  void begin(float iso);
  /// Takes the numbers of the planes from `first` on, `count` of them, in the tiles of `values`; `before` has those of
  /// the planes before them, of which iso-surfaces and slabs need the last tile (from plane 0 on, any). In order.
  void add(const hbOglRays& rays, int first, int count, const hbOglTiles& tiles, const hbGlTarget& before,
           const hbGlTarget& values);

  /// Per pixel the sum, the greatest or kLeast, or the place of the first crossing or hbOglRays::kNowhere.
  /// DVR: the four channels of hbPlaneRays::dvr(), those of rays that meet no plane 0.
  const hbGlTarget& found() const { return *found_; }

private:
  const hbGlFunctions& gl_;
  hbMode mode_;
  const hbOglMatter* matter_;
  float iso_ = 0.0F;
  hbGlQuad quad_;
  hbGlProgram program_;
  std::unique_ptr<hbGlTarget> found_;
  std::unique_ptr<hbGlTarget> before_; ///< DVR: what was found up to the lot before.
};
