#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "glcombine/hbGlFormat.h"
#include "glcombine/hbTextureLayout.h"
#include "raycast/hbPlaneRays.h"
#include "sparsegrid/hbCombinationSparseGrid.h"

class hbGlContext;
class hbGlTarget;
class hbOglRays;
class hbOglTiles;

/// A sparse grid combined by texture hardware: each component grid is a 3D texture, and for a plane of samples all of
/// them are drawn over each other, blended by their coefficients.
///
/// Fixed-point textures and targets hold [0,1] and clamp what is outside. Values are mapped there by the range of all
/// nodal values, and what is drawn is divided by the sum of the positive coefficients. Where the coefficients sum to 1
/// the combination is mapped alike; where they sum to S, a number 0 stands for S times what it stands for in textures,
/// so that the range begins at the least nodal value / S where that is less (S > 0). There is room above for what lies
/// between nodes and exceeds them; what falls below the least of them is clamped (S <= 0: whatever falls below S times
/// it). For 16-bit floats, values are divided by the largest magnitude. Source: the
/// sparse-grid paper, section 6, createTextures, dataToTexture, calcValueRect, draw.
class hbOglSparseGrid {
public:
  enum class Order : std::uint8_t {
    positiveFirst, ///< As the paper has it: all positive coefficients, then all negative ones. Partial sums grow large.
    interleaved    ///< Partial sums of the coefficients stay small, and so do rounding errors. Not where targets clamp.
  };
  enum class Filter : std::uint8_t {
    hardware, ///< Textures are interpolated as the device does it; graphics processors know 8 bits between texels.
    exact     ///< The shader reads eight texels and interpolates them in 32 bits.
  };
  struct Options {
    hbGlFormat textures = hbGlFormat::r32f;
    hbGlFormat target = hbGlFormat::r32f;
    hbTextureLayout::Form form = hbTextureLayout::Form::exact;
    std::optional<Order> order = std::nullopt; ///< Interleaved where the target is a float.
    Filter filter = Filter::hardware;
    /// Bytes of textures on the device at a time.
    std::int64_t memory = std::numeric_limits<std::int64_t>::max();
    bool stream = false; ///< Hand textures over again and again where they do not all fit.
  };
  using Plane = hbPlaneRays::Plane;

  /// Keeps a reference to `context`, which must be current now and wherever the object is used, its end included.
  /// Uploads the component. Throws hbError where a texture is refused, the memory does not suffice, or the order does
  /// not go with the target.
  hbOglSparseGrid(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
                  const Options& options);
  ~hbOglSparseGrid();

  /// Blends the values on planes[i] into the i-th tile of the target, of Options::target, which is cleared first. What
  /// is in a target stands for valueOf() it; of samples outside the planes' windows or the cube it is anything finite.
  /// One draw for each texture; when streaming, textures that are not kept are handed over once a call.
  void draw(std::span<const Plane> planes, const hbOglTiles& tiles, const hbGlTarget& target) const;

  /// Field value = valueOf(0) + number in a target * (valueOf(1) - valueOf(0)).
  double valueOf(double number) const;

  /// For each pixel the value, less valueOf(0), and its central differences by x, y and z of the cube, where `places`
  /// says: those of hbSurfaceShader. Into four channels, which are cleared first; pixels that are nowhere get anything.
  /// Summed in 32 bits, whatever the target's format else. Seven texels a texture and pixel.
  void differences(const hbOglRays& rays, const hbGlTarget& places, const hbGlTarget& out) const;

  /// Of all texels, empty ones included.
  std::int64_t textureBytes() const;
  /// Of those that are on the device all the time.
  std::int64_t residentBytes() const;
  /// Textures, which is blends a plane.
  std::int64_t textures() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
