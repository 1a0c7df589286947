#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "glcombine/hbGlFormat.h"
#include "glcombine/hbTextureLayout.h"
#include "sparsegrid/hbCombinationSparseGrid.h"

class hbGlContext;

/// A sparse grid combined by texture hardware: each component grid is a 3D texture, and for a plane of samples all of
/// them are drawn over each other, blended by their coefficients: the positive ones first, added, then the negative
/// ones, subtracted.
///
/// In fixed-point textures and targets, which clamp to [0,1], values are mapped to [0,1] by the range of all nodal
/// values (the coefficients sum to 1, so the combination is mapped alike), and what is drawn is divided by the sum of
/// the positive coefficients. Source: the sparse-grid paper, section 6, createTextures, dataToTexture, calcValueRect,
/// draw.
class hbOglSparseGrid {
public:
  struct Options {
    hbGlFormat textures = hbGlFormat::r32f;
    hbGlFormat target = hbGlFormat::r32f;
    hbTextureLayout::Form form = hbTextureLayout::Form::exact;
  };

  /// A rectangle of samples in the cube: sample (x, y) of width * height at corner + (x + 1/2) right + (y + 1/2) down.
  struct Plane {
    glm::dvec3 corner{0.0}, right{0.0}, down{0.0};
    int width = 1, height = 1;
  };

  /// Keeps a reference to `context`, which must be current now and wherever the object is used, its end included.
  /// Uploads the component. Throws hbError where a texture is refused.
  hbOglSparseGrid(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
                  const Options& options);
  ~hbOglSparseGrid();

  /// out[x + width y] = the value at that sample; outside the cube the value that stands for 0 in the target (see
  /// above; mask such samples). One draw for each texture, and one read-back.
  void values(const Plane& plane, std::vector<float>& out) const;

  /// Of all texels, empty ones included.
  std::int64_t textureBytes() const;
  /// Textures, which is draws a plane.
  std::int64_t textures() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
