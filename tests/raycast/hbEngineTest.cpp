#include "raycast/hbEngine.h"

#include <gtest/gtest.h>

#include "volume/hbError.h"

TEST(hbEngine, NamesRoundTrip) {
  for (const hbEngine engine : {hbEngine::automatic, hbEngine::full, hbEngine::direct, hbEngine::seminodal,
                                hbEngine::combination, hbEngine::lattice, hbEngine::opengl})
    EXPECT_EQ(hb::engineFromName(hb::engineName(engine)), engine);
  EXPECT_THROW(hb::engineFromName("fast"), hbError);
}
