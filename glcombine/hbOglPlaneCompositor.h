#pragma once

#include <limits>

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglRays.h"
#include "glcombine/hbOglTiles.h"

/// hbPlaneCompositor on the device: X-ray adds planes up in one float target, MIP keeps the greatest by GL_MAX, and
/// where two consecutive planes lie on either side of the iso-value the nearest place is kept by GL_MIN. The context
/// must be current wherever it is used.
class hbOglPlaneCompositor {
public:
  /// What stands for a MIP's maximum where there is no sample.
  static constexpr float kLeast = std::numeric_limits<float>::lowest();

  /// Keeps a reference to `gl`; for pictures of the scene's mode and size.
  hbOglPlaneCompositor(const hbGlFunctions& gl, const hbScene& scene);

  /// Begins a picture. `iso`: the iso-value as numbers in targets have it.
  void begin(float iso);
  /// Takes the numbers of the planes from `first` on, `count` of them, in the tiles of `values`; `before` has those of
  /// the planes before them, of which iso-surfaces need the last tile (from plane 0 on, any). In order.
  void add(const hbOglRays& rays, int first, int count, const hbOglTiles& tiles, const hbGlTarget& before,
           const hbGlTarget& values);

  /// Per pixel the sum, the greatest or kLeast, or the place of the first crossing or hbOglRays::kNowhere.
  const hbGlTarget& found() const { return found_; }

private:
  const hbGlFunctions& gl_;
  hbMode mode_;
  float iso_ = 0.0F;
  hbGlQuad quad_;
  hbGlProgram program_;
  hbGlTarget found_;
};
