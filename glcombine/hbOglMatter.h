#pragma once

#include <optional>
#include <string>
#include <utility>

#include "glcombine/hbGlBuffer.h"
#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlTexture.h"
#include "raycast/hbMatter.h"
#include "volume/hbValueMap.h"

/// hbMatter and hbEmissionAbsorption for shaders, in 32 bits: samples in a texture buffer (64 kB), slabs in a texture
/// (16 MB). Shaders interpolate by themselves, as filters of textures may take their fractions in 8 bits, and have an
/// exponential and a logarithm of their own, as OpenGL 3.3 promises no accuracy of its.
///
/// The context must be current wherever it is used, its end included.
class hbOglMatter {
public:
  /// Keeps a reference to `gl`. `numbers`: what the numbers that shaders see stand for as true values. `isLit`: whether
  /// pieces of matter are lit by hbOglLight::glsl(), which is to follow glsl(), or shown as they are.
  hbOglMatter(const hbGlFunctions& gl, const hbMatter& matter, const hbValueMap& numbers, bool isLit = false);

  bool isPreintegrated() const { return !entries_; }
  bool isLit() const { return isLit_; }

  /// GLSL (330) that declares
  ///   bool isOpaque(vec4 seen): whether nothing behind shows, by hbEmissionAbsorption's limit; `seen` is light, in
  ///     linear red, green and blue multiplied by the opacity, and in .a the opacity: 0 before a ray's first sample,
  ///   void addSample(inout vec4 seen, int plane, ivec2 planes, vec3 lengths, float before, float number): adds a ray's
  ///     sample on a plane, or the slab before it, front to back; `planes` and `lengths` as hbOglRays has them,
  ///     `before` the number on the plane before,
  /// and what it is made of: vec4 matterAt(float number), which is hbTransferTable::at() with the extinction of a step,
  /// or vec4 slabAt(float front, float back), which is hbPreintegration::at(); float absorbed(float depth), which is
  /// 1 - exp(-depth), and float depthOf(float opacity), the other way round, within 8 units of 2^-24 of them.
  const std::string& glsl() const { return glsl_; }
  /// Sets what glsl() needs in the program in use; the texture of that unit is taken.
  void set(const hbGlProgram& program, int unit) const;

  /// Of a scene's tables, in main memory and on the device.
  static double bytes(bool isPreintegrated);

private:
  void setRange(std::pair<double, double> range, std::size_t entries, const hbValueMap& numbers);

  bool isLit_;
  std::string glsl_;
  float low_ = 0.0F, high_ = 0.0F, perNumber_ = 0.0F; ///< Numbers of the first and the last entry, entries a number.
  std::optional<hbGlBuffer> entries_;
  hbGlTexture texture_;
};
