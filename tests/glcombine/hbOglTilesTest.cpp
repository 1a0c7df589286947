#include "glcombine/hbOglTiles.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

RC_GTEST_PROP(hbOglTiles, TilesLieApartWithinTheTarget, ()) {
  const int width = *rc::gen::inRange(1, 3000), height = *rc::gen::inRange(1, 3000);
  const int planes = *rc::gen::inRange(1, 500), most = *rc::gen::inRange(3000, 20000);
  const hbOglTiles tiles(width, height, planes, most);
  RC_ASSERT(tiles.count() >= 1 && tiles.count() <= std::min(planes, hbOglTiles::kMost));
  RC_ASSERT(tiles.targetWidth() <= most && tiles.targetHeight() <= most);
  RC_ASSERT(tiles.count() == 1 || double(tiles.count()) * width * height <= 1 << 22);
  for (int i = 0; i < tiles.count(); ++i) {
    RC_ASSERT(tiles.x(i) + width <= tiles.targetWidth() && tiles.y(i) + height <= tiles.targetHeight());
    for (int j = 0; j < i; ++j)
      RC_ASSERT(tiles.x(i) - tiles.x(j) >= width || tiles.x(j) - tiles.x(i) >= width ||
                tiles.y(i) - tiles.y(j) >= height || tiles.y(j) - tiles.y(i) >= height);
  }
}

TEST(hbOglTiles, SmallPicturesShareATargetAndLargeOnesDoNot) {
  EXPECT_EQ(hbOglTiles(200, 200, 128, 16384).count(), hbOglTiles::kMost);
  EXPECT_EQ(hbOglTiles(1024, 1024, 128, 16384).count(), 4);
  EXPECT_EQ(hbOglTiles(4096, 4096, 128, 16384).count(), 1);
  EXPECT_EQ(hbOglTiles(16384, 16384, 128, 16384).count(), 1);
}
