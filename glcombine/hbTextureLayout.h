#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "volume/hbGeometry.h"

/// How a component grid of (2^l + 1) nodes an axis (1 on a flat one) lies in 3D textures, with its nodes on the centres
/// of texels.
///
/// An axis that is longer than the hardware allows is split into pieces that share a plane of nodes. Source: the
/// sparse-grid paper, section 6, dataToTexture and calcValueRect.
class hbTextureLayout {
public:
  enum class Form : std::uint8_t {
    padded, ///< 2^(l+1) texels an axis, as hardware wanted powers of two: half of each axis and more is empty.
    exact   ///< As many texels as nodes.
  };

  /// One piece of one axis.
  struct Piece {
    std::int64_t firstNode = 0, nodes = 1;
    std::int64_t texels = 1;
    double from = 0.0, to = 1.0; ///< The part of the grid's axis, in its [0,1].
    double scale = 0.0;          ///< Texture coordinate = offset + scale * place in [0,1] along the whole axis.
    double offset = 0.5;
  };

  /// `levels`: of the grid; ignored on flat axes. `mostTexels`: GL_MAX_3D_TEXTURE_SIZE, at least 4.
  hbTextureLayout(const glm::ivec3& levels, const glm::bvec3& flat, Form form, std::int64_t mostTexels);

  /// The pieces of an axis, in order; more than one where it is too long.
  const std::vector<Piece>& pieces(int axis) const { return pieces_[std::size_t(axis)]; }
  /// Textures: all combinations of pieces.
  std::int64_t textures() const;
  /// Texels of all textures together.
  std::int64_t texels() const;

private:
  std::array<std::vector<Piece>, 3> pieces_;
};
