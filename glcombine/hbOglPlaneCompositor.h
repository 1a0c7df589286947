#pragma once

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglRays.h"

/// hbPlaneCompositor on the device: X-ray adds planes up in one float target, MIP keeps the greatest by GL_MAX, and
/// where two consecutive planes lie on either side of the iso-value the nearest place is kept by GL_MIN. The context
/// must be current wherever it is used.
class hbOglPlaneCompositor {
public:
  /// What stands for a MIP's maximum where there is no sample.
  static constexpr float kLeast = -1e30F;

  /// Keeps references to `gl` and `rays`. `iso`: the iso-value as numbers in targets have it.
  hbOglPlaneCompositor(const hbGlFunctions& gl, const hbOglRays& rays, float iso);

  /// Takes the numbers of a plane and, for iso-surfaces, of the plane before it (of plane 0 any); planes in order.
  void add(int index, const hbGlTarget& before, const hbGlTarget& values);

  /// Per pixel the sum, the greatest or kLeast, or the place of the first crossing or hbOglRays::kNowhere.
  const hbGlTarget& found() const { return found_; }

private:
  const hbGlFunctions& gl_;
  const hbOglRays& rays_;
  float iso_;
  hbGlQuad quad_;
  hbGlProgram program_;
  hbGlTarget found_;
};
