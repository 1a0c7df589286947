#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <glm/vec3.hpp>

#include "glcombine/hbGlBuffer.h"
#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlTexture.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSemiNodalGrid.h"

class hbGlContext;

/// One component of a sparse grid for shaders to evaluate at any point, in 32 bits: its values in one texture buffer,
/// what there is to know of its terms in a uniform block. Shaders interpolate by themselves, as filters of textures
/// may take their fractions in 8 bits.
///
/// The context must be current wherever it is used, its end included.
class hbOglValues {
public:
  /// What the hardware takes.
  struct Limits {
    std::int64_t values = 0;     ///< GL_MAX_TEXTURE_BUFFER_SIZE, below 2^31.
    std::int64_t blockBytes = 0; ///< GL_MAX_UNIFORM_BLOCK_SIZE.

    static Limits of(const hbGlFunctions& gl);
  };

  /// All component grids, summed with their coefficients in the order of hb::interleaved(): 8 fetches a term. Keeps a
  /// reference to `context`. Throws hbError naming what exceeds the limits, by default the context's.
  hbOglValues(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
              const std::optional<Limits>& limits = std::nullopt);
  /// The lines along x: 2 fetches a term. Likewise.
  hbOglValues(const hbGlContext& context, const hbSemiNodalGrid& grid, int component,
              const std::optional<Limits>& limits = std::nullopt);

  /// GLSL (330) that declares float valueAt(vec3 point), of the cube, to which points are clamped (NaN to 0).
  const std::string& glsl() const { return glsl_; }
  /// Turns of loops that valueAt() takes, as hbGlProgram::kMostTurns counts them. Where uniform blocks have 64 kB, 2100
  /// at the most.
  int turns() const { return turns_; }
  /// Sets what glsl() needs in the program in use; the texture of that unit and the first GL_UNIFORM_BUFFER are taken.
  void set(const hbGlProgram& program, int unit) const;

  /// Of the values.
  std::int64_t textureBytes() const { return bytes_; }

private:
  struct Table;
  hbOglValues(const hbGlFunctions& gl, const Table& table, std::span<const float> values);

  const hbGlFunctions& gl_;
  std::string glsl_;
  int rows_, turns_;
  glm::vec3 scale_;
  std::int64_t bytes_;
  hbGlBuffer values_, block_;
  hbGlTexture texture_;
};
