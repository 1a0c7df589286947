#pragma once

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlTexture.h"
#include "raycast/hbPlaneRays.h"

/// The planes and rays of a planewise picture, for shaders that draw one fragment a pixel. The context must be current
/// wherever it is used.
class hbOglRays {
public:
  /// What stands for "nowhere along the ray" where a shader writes a place.
  static constexpr float kNowhere = 1e30F;

  /// GLSL (330) that declares
  ///   ivec2 planesOfRay(): the first and the last plane on which this fragment's ray is in the volume,
  ///   vec3 pointOfRay(float place): in the cube; places are indices of planes and parts of them,
  ///   vec3 directionOfRay(): in the world, of length 1,
  ///   vec3 lengthsOfRay(): of DVR scenes, the world lengths before the first plane, between two, and behind the last,
  ///     in distances of planes,
  ///   const float kNowhere.
  static const char* glsl();

  /// Keeps references to `gl` and `rays`, and uploads 8 bytes a pixel, for DVR 16.
  hbOglRays(const hbGlFunctions& gl, const hbPlaneRays& rays);

  /// Sets what glsl() needs in the program in use; the texture of that unit is taken for it.
  void set(const hbGlProgram& program, int unit) const;

  const hbPlaneRays& planes() const { return rays_; }

private:
  const hbPlaneRays& rays_;
  hbGlTexture ranges_;
};
