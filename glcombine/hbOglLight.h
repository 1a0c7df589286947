#pragma once

#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "glcombine/hbGlProgram.h"
#include "scene/hbScene.h"
#include "volume/hbField.h"

/// hbShading and gradient opacity for shaders, in 32 bits: what hbLitPieces does with a piece of matter.
class hbOglLight {
public:
  /// Of a scene of `field`.
  hbOglLight(const hbField& field, const hbScene& scene);

  /// GLSL (330) that declares void shine(inout vec3 colour, inout float depth, float place): the colour as it is lit,
  /// and the optical depth as far as it is shown, of a piece of matter whose middle is at that place of the ray. Six
  /// evaluations of the field where `depth` is not 0. It stands behind hbOglRays::glsl(), hbOglValues::glsl() and
  /// hbOglMatter::glsl(), which it completes.
  static const char* glsl();
  /// Turns of loops that shine() takes at the most, as hbGlProgram::kMostTurns counts them, where valueAt() takes
  /// `ofValue`.
  static int turns(int ofValue);
  /// Sets what glsl() needs in the program in use.
  void set(const hbGlProgram& program) const;

private:
  glm::vec3 spacing_, reflected_{1.0F, 0.0F, 0.0F}, shown_{0.0F, -1.0F, 1.0F};
  float shininess_ = 1.0F;
  glm::mat3 cubeToWorld_, gradientToWorld_;
  std::vector<glm::vec3> places_, colours_; ///< Of the lights; places from the cube's corner.
};
