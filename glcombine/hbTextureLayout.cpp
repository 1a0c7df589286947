#include "glcombine/hbTextureLayout.h"

#include <algorithm>

hbTextureLayout::hbTextureLayout(const glm::ivec3& levels, const glm::bvec3& flat, Form form, std::int64_t mostTexels) {
  for (int d = 0; d < 3; ++d) {
    std::vector<Piece>& pieces = pieces_[std::size_t(d)];
    if (flat[d]) {
      pieces.emplace_back();
      continue;
    }
    const std::int64_t cells = std::int64_t{1} << levels[d];
    const auto texelsOf = [&](std::int64_t count) { return form == Form::padded ? 2 * count : count + 1; };
    std::int64_t pieceCells = cells;
    while (texelsOf(pieceCells) > mostTexels) pieceCells /= 2;
    for (std::int64_t first = 0; first < cells; first += pieceCells) {
      Piece piece;
      piece.firstNode = first;
      piece.nodes = pieceCells + 1;
      piece.texels = texelsOf(pieceCells);
      piece.from = double(first) / double(cells);
      piece.to = double(first + pieceCells) / double(cells);
      // Node k of the axis is texel k - first, whose centre has the coordinate (k - first + 1/2) / texels.
      piece.scale = double(cells) / double(piece.texels);
      piece.offset = (0.5 - double(first)) / double(piece.texels);
      pieces.push_back(piece);
    }
  }
}

std::int64_t hbTextureLayout::textures() const {
  return std::int64_t(pieces_[0].size() * pieces_[1].size() * pieces_[2].size());
}

std::int64_t hbTextureLayout::texels() const {
  std::int64_t product = 1;
  for (const std::vector<Piece>& axis : pieces_) {
    std::int64_t sum = 0;
    for (const Piece& piece : axis) sum += piece.texels;
    product *= sum;
  }
  return product;
}
