#include "scene/hbMode.h"

#include <gtest/gtest.h>

#include "volume/hbError.h"

TEST(hbMode, NamesRoundTrip) {
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso, hbMode::dvr, hbMode::slice})
    EXPECT_EQ(hb::modeFromName(hb::modeName(mode)), mode);
}

TEST(hbMode, RefusesUnknownNames) { EXPECT_THROW(hb::modeFromName("xrays"), hbError); }
