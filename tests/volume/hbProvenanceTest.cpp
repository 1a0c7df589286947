#include "volume/hbProvenance.h"

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

TEST(hbProvenance, ComesBackWhole) {
  const hbProvenance provenance{R"({"command": "hbvol compress a.nrrd b.hbv", "größe": [1, 2]})"};
  EXPECT_EQ(hbProvenance::decode(provenance.encode(), "x"), provenance);
}

TEST(hbProvenance, RefusesLongAndOtherTexts) {
  for (const char* text : {"", "{", "{\"a\": \"\xFF\"}", "command"})
    EXPECT_HB_ERROR(hbProvenance::decode(hb::test::bytesOf(text), "x"), "x: expected JSON, found another text");
  EXPECT_HB_ERROR(hbProvenance{"no JSON"}.encode(), "provenance: expected JSON");
  // A string of JSON of exactly 1 MiB, and one byte more.
  const std::string most = '"' + std::string((1U << 20U) - 2, 'a') + '"';
  EXPECT_EQ(hbProvenance::decode(hb::test::bytesOf(most), "x").json, most);
  EXPECT_HB_ERROR(hbProvenance::decode(hb::test::bytesOf(most + ' '), "x"),
                  "x: expected at most 1048576 bytes of JSON, found 1048577");
}

TEST(hbProvenance, DeepNestingIsHarmless) {
  const std::string deep = std::string(500000, '[') + std::string(500000, ']');
  EXPECT_EQ(hbProvenance::decode(hb::test::bytesOf(deep), "x").json, deep);
}
