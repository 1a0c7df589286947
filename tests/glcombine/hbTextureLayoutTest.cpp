#include "glcombine/hbTextureLayout.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbIndexSet.h"

using Form = hbTextureLayout::Form;

RC_GTEST_PROP(hbTextureLayout, NodesAreTexelCentresAndPiecesShareAPlane, ()) {
  glm::ivec3 levels;
  glm::bvec3 flat;
  for (int d = 0; d < 3; ++d) {
    levels[d] = *rc::gen::inRange(0, 12);
    flat[d] = *rc::gen::inRange(0, 4) == 0;
  }
  const Form form = *rc::gen::element(Form::padded, Form::exact);
  const std::int64_t most = std::int64_t{1} << *rc::gen::inRange(2, 13);
  const hbTextureLayout layout(levels, flat, form, most);
  for (int d = 0; d < 3; ++d) {
    const std::int64_t cells = flat[d] ? 0 : std::int64_t{1} << levels[d];
    std::int64_t next = 0;
    for (const hbTextureLayout::Piece& piece : layout.pieces(d)) {
      RC_ASSERT(piece.firstNode == next);
      RC_ASSERT(piece.texels <= most);
      RC_ASSERT(piece.nodes <= piece.texels);
      if (flat[d]) RC_ASSERT(piece.offset + piece.scale * 0.3 == 0.5);
      for (std::int64_t k = 0; k < piece.nodes && !flat[d]; k += std::max<std::int64_t>(1, piece.nodes / 7)) {
        const double place = double(piece.firstNode + k) / double(cells);
        RC_ASSERT(place >= piece.from);
        RC_ASSERT(place <= piece.to);
        // Two operations in 64 bits on numbers up to the number of pieces (2^12 at most).
        RC_ASSERT(std::abs((piece.offset + piece.scale * place) * double(piece.texels) - (double(k) + 0.5)) <= 0x1p-36);
      }
      next += piece.nodes - 1;
    }
    RC_ASSERT(next == cells);
  }
}

TEST(hbTextureLayout, PaddedTextelsAreThoseOfTheTableAndExactOnesLessThanHalf) {
  const std::int64_t table[] = {22016, 63488, 173056, 452608, 1146880, 2834432, 6864896};
  for (int level = 5; level <= 11; ++level) {
    const hbIndexSet set = hbIndexSet::regular(level, {});
    std::int64_t padded = 0, exact = 0;
    for (const hbIndexSet::ComponentGrid& grid : set.componentGrids()) {
      padded += hbTextureLayout(grid.levels, set.flat(), Form::padded, 1 << 20).texels();
      exact += hbTextureLayout(grid.levels, set.flat(), Form::exact, 1 << 20).texels();
    }
    EXPECT_EQ(padded, table[level - 5]) << level;
    EXPECT_EQ(padded, set.paddedTexels()) << level;
    EXPECT_EQ(exact, set.combinationValues()) << level;
    EXPECT_LT(2 * exact, padded) << level;
  }
}

TEST(hbTextureLayout, LevelElevenIsSplitWhere2048IsTheMost) {
  const glm::bvec3 none(false);
  const hbTextureLayout exact({11, 1, 1}, none, Form::exact, 2048), padded({11, 1, 1}, none, Form::padded, 2048);
  ASSERT_EQ(exact.pieces(0).size(), 2U);
  EXPECT_EQ(exact.pieces(0)[1].firstNode, 1024);
  EXPECT_EQ(exact.texels(), 2 * 1025 * 3 * 3);
  EXPECT_EQ(exact.textures(), 2);
  ASSERT_EQ(padded.pieces(0).size(), 2U);
  EXPECT_EQ(padded.pieces(0)[0].texels, 2048);
  EXPECT_EQ(padded.pieces(1).size(), 1U);
}
