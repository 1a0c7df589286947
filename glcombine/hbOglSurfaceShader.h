#pragma once

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglRays.h"

/// Normals and Lambert's light of surfaces, from central differences: what hbSurfaceShader makes of them, on the
/// device. The context must be current wherever it is used.
class hbOglSurfaceShader {
public:
  /// Keeps a reference to `gl`.
  explicit hbOglSurfaceShader(const hbGlFunctions& gl);

  /// `differences`: of four channels, the last three by x, y and z of the cube. Writes the world normal towards the
  /// viewer and then the light into the four channels of `out`.
  void shade(const hbOglRays& rays, const hbGlTarget& differences, const hbGlTarget& out) const;

private:
  const hbGlFunctions& gl_;
  hbGlQuad quad_;
  hbGlProgram program_;
};
