#include <cmath>

#include "tests/apps/hbAppTest.h"
#include "volume/hbVolumeReader.h"

class extract : public hbAppTest {};

TEST_F(extract, GivesBackEverySampleOfAnAlignedFullSet) {
  // Rough data of unlike sizes, none of them 2^n + 1.
  writeVolume<std::uint8_t>("v.nrrd", {13, 10, 7}, 1, [](auto x, auto y, auto z, int) {
    return double((x * 97 + y * 57 + z * 31 + x * y * z) % 256);
  });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--mapping", "aligned", "--index-set", "full"}));
  const hbProgramRun made = run({"extract", "v.hbv", "e.nrrd", "--stats", "s.json"});
  EXPECT_RUNS(made);
  EXPECT_EQ(json("s.json")["samples"], 13 * 10 * 7);
  EXPECT_TRUE(json("s.json")["seconds"].is_number());
  const hbVolume before = hb::readVolume(folder_ / "v.nrrd"), after = hb::readVolume(folder_ / "e.nrrd");
  ASSERT_EQ(after.geometry(), before.geometry());
  for (int z = 0; z < 7; ++z)
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 13; ++x) ASSERT_EQ(std::nearbyint(after.value(x, y, z)), before.value(x, y, z));
}

TEST_F(extract, KeepsTheBoxAtAnotherSize) {
  write("v.nhdr",
        "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 5 3 1\nspace dimension: 3\n"
        "space directions: (2,0,0) (0,0,3) (0,4,0)\nspace origin: (10,20,30)\nencoding: raw\ndata file: v.raw\n");
  write("v.raw", std::string(15, '\7'));
  const hbVolume source = hb::readVolume(folder_ / "v.nhdr");
  for (const char* size : {"9x5x2", "3x1x1", "4"}) {
    EXPECT_RUNS(run({"extract", "v.nhdr", "e.nrrd", "--size", size}));
    const hbVolume made = hb::readVolume(folder_ / "e.nrrd");
    EXPECT_EQ(made.value(made.geometry().size.x - 1, 0, 0), 7.0);
    // The same cube in the world. Coordinates below 64 after a few operations, written in full.
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row)
        EXPECT_NEAR(made.geometry().cubeToWorld()[column][row], source.geometry().cubeToWorld()[column][row],
                    64 * 0x1p-50)
            << size;
  }
}

TEST_F(extract, RefusesBadInputAndSizes) {
  writeVolume<float>("v.nrrd", {3, 3, 3}, 1, [](auto x, auto, auto, int) { return double(x); });
  write("damaged.hbv", "no container at all");
  expectFailureLeavesAll({"extract", "damaged.hbv", "x.nrrd"}, 1, "damaged.hbv");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "0x5x5"}, 1, "--size");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "1048576"}, 1, "2^60");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--sizes", "5"}, 2, "--sizes");
}
