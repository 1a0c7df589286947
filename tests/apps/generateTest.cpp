#include "tests/apps/hbAppTest.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeReader.h"

class generate : public hbAppTest {};

TEST_F(generate, WritesTheFieldAtTheSamples) {
  for (const char* name : {"g.nrrd", "g.vti", "g_5x4x1_float32.raw"}) {
    const hbProgramRun made = run({"generate", "smooth", name, "--size", "5x4x1", "--stats", "s.json"});
    EXPECT_RUNS(made);
    EXPECT_EQ(json("s.json")["samples"], 20);
    EXPECT_TRUE(json("s.json")["seconds"].is_number());
    if (std::string(name) == "g.vti") continue; // written, not read
    const hbVolume volume = hb::readVolume(folder_ / name);
    ASSERT_EQ(volume.geometry().size, hbSize3(5, 4, 1));
    EXPECT_EQ(volume.type(), hbSampleType::float32);
    const auto field = hbAnalyticField::create("smooth");
    // Samples are the formula's values rounded to floats; a flat axis shows its middle.
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 5; ++x)
        EXPECT_EQ(volume.value(x, y, 0), double(float(field->value({x / 4.0, y / 3.0, 0.5}))));
  }
}

TEST_F(generate, RefusesBadNamesAndSizes) {
  expectFailureLeavesAll({"generate", "none", "x.nrrd"}, 1, "none");
  expectFailureLeavesAll({"generate", "ball,radius=wide", "x.nrrd"}, 1, "radius");
  for (const char* size : {"0", "0x4x4", "-3", "4x4", "4x4x4x4", "x", "4x4x", "99999999999999999999", "four"})
    expectFailureLeavesAll({"generate", "ball", "x.nrrd", "--size", size}, 1, "--size");
  // A raw file's name must say what it holds.
  expectFailureLeavesAll({"generate", "ball", "x_3x3x4_float32.raw", "--size", "3"}, 1, "x_3x3x4_float32.raw");
  // 2^60 samples.
  expectFailureLeavesAll({"generate", "ball", "x.nrrd", "--size", "1048576"}, 1, "2^60");
}
