#include "raycast/hbFullGrid.h"

#include <gtest/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbTestScenes.h"
#include "volume/hbError.h"

using namespace hbTestScenes;

TEST(hbFullGrid, HasTheGridsValuesAtItsSamples) {
  const hbGeometry g = awkward();
  // The second's values are so far from 0 that they are kept with an offset.
  const hbSparseGrid grid = gridOf(
      g, 3,
      {[](const glm::dvec3& p) { return 1e9 + waves(p); }, [](const glm::dvec3& p) { return 1e9 + p.x * p.y - p.z; }});
  ASSERT_NE(grid.valueMap().offset, 0.0);
  const hbVolume volume = hb::extractFullGrid(grid);
  EXPECT_EQ(volume.geometry(), g);
  EXPECT_EQ(volume.components(), 2);
  EXPECT_EQ(hb::fullGridBytes(grid), 2.0 * 4.0 * 9 * 17 * 9);
  for (int c = 0; c < 2; ++c) {
    // hbShearReference::rounding(), at level 4 at most.
    const double tolerance = (15 + 8) * 0x1p-24 * hb::amplitude(grid, c) * grid.valueMap().scale;
    for (int k = 0; k < 9; ++k)
      for (int j = 0; j < 17; ++j)
        for (int i = 0; i < 9; ++i) {
          const double expected = grid.valueMap().toTrue(grid.calcValue({i / 8.0, j / 16.0, k / 8.0}, c));
          ASSERT_NEAR(volume.value(i, j, k, c), expected, tolerance + 1e9 * 0x1p-52);
        }
  }
}

TEST(hbFullGrid, StopsWhenCancelled) {
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::extractFullGrid(gridOf(awkward(), 2, {waves}), progress), hbCancelled);
}
