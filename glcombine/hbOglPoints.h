#pragma once

#include <span>

#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbOglValues.h"
#include "volume/hbField.h"

class hbGlContext;

/// Evaluates hbOglValues at given points, by a shader that does nothing else: what the device makes of a sparse grid,
/// without a picture. The context must be current wherever it is used, its end included.
class hbOglPoints {
public:
  /// Keeps references to both.
  hbOglPoints(const hbGlContext& context, const hbOglValues& values);

  /// out[i] = the value at point i. Points and values pass through textures of 16 bytes a point.
  void values(const hbPoints& points, std::span<float> out) const;

private:
  const hbGlFunctions& gl_;
  const hbOglValues& values_;
  hbGlProgram program_;
  hbGlQuad quad_;
};
