#include <algorithm>

#include <fmt/format.h>

#include "tests/apps/hbAppTest.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/fields/hbCavitySpecification.h"
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

TEST_F(generate, WritesTheSimulatedCavity) {
  const hbProgramRun made = run({"generate", "cavity,quantity=temperature,reynolds=100,tolerance=0.01", "t.nrrd",
                                 "--size", "17", "--stats", "s.json"});
  EXPECT_RUNS(made);
  EXPECT_EQ(std::count(made.out.begin(), made.out.end(), '\n'), 1);
  for (const char* words : {"t.nrrd", "17 x 17 x 17", "temperature", "Re=100", "steady", "time steps"})
    EXPECT_NE(made.out.find(words), std::string::npos) << made.out;
  const auto stats = json("s.json");
  EXPECT_EQ(stats["samples"], 17 * 17 * 17);
  EXPECT_EQ(stats["steady"], true);
  EXPECT_LE(stats["residual"], 0.01);
  EXPECT_GT(stats["steps"], 0);
  EXPECT_GT(stats["time"], 0.0);
  EXPECT_EQ(stats["files"], nlohmann::json({"t.nrrd"}));
  const auto specification = hbCavitySpecification::parse(stats["specification"].get<std::string>());
  EXPECT_EQ(specification.flow.reynolds, 100.0);
  hbCavityFlow flow(specification.flow, 17);
  flow.runToSteady(0.01, 4000);
  const auto expected = flow.nodal(specification.quantity);
  const hbVolume volume = hb::readVolume(folder_ / "t.nrrd");
  ASSERT_EQ(volume.geometry(), flow.geometry());
  EXPECT_EQ(volume.componentNames(), std::vector<std::string>{"temperature"});
  for (std::int64_t i = 0; i < 17 * 17 * 17; ++i)
    ASSERT_EQ(float(volume.value(i % 17, i / 17 % 17, i / 289)), expected[std::size_t(i)]);
}

TEST_F(generate, WritesAVolumeATimeStep) {
  EXPECT_RUNS(run(
      {"generate", "cavity,quantity=speed,end-time=0.3", "c.vti", "--size", "9", "--steps", "3", "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["files"], nlohmann::json({"c_0000.vti", "c_0001.vti", "c_0002.vti"}));
  EXPECT_EQ(json("s.json")["samples"], 3 * 729);
  EXPECT_EQ(json("s.json")["time"], 0.3);
  EXPECT_EQ(json("s.json")["steady"], false);
  EXPECT_EQ(contents().size(), 4U);
  // Raw files keep their names' form, and hold what the flow was at equal times.
  EXPECT_RUNS(
      run({"generate", "cavity,quantity=speed,end-time=0.3", "c_9x9x9_float32.raw", "--size", "9", "--steps", "3"}));
  hbCavityFlow flow({}, 9);
  for (int i = 0; i < 3; ++i) {
    flow.advanceTo(0.3 * double(i + 1) / 3.0);
    const hbVolume volume = hb::readVolume(folder_ / fmt::format("c_000{}_9x9x9_float32.raw", i));
    const auto expected = flow.nodal(hbCavityFlow::Quantity::speed);
    for (std::int64_t s = 0; s < 729; ++s)
      ASSERT_EQ(float(volume.value(s % 9, s / 9 % 9, s / 81)), expected[std::size_t(s)]);
  }
  // An end time without steps: the flow of that moment.
  EXPECT_RUNS(run({"generate", "cavity,quantity=speed,end-time=0.3", "one_9x9x9_float32.raw", "--size", "9"}));
  const hbVolume one = hb::readVolume(folder_ / "one_9x9x9_float32.raw");
  EXPECT_GT(one.value(4, 8, 4), 0.99); // the lid
}

TEST_F(generate, RefusesCavitiesThatCannotBe) {
  expectFailureLeavesAll({"generate", "cavity,reynolds=-1", "x.nrrd"}, 1, "reynolds");
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "16"}, 1, "odd number of nodes");
  // Before the memory: no machine has that of these.
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "100001"}, 1, "nodes from 9 to 257, found 100001");
  expectFailureLeavesAll({"generate", "cavity,reynolds=10000,richardson=-10", "x.nrrd", "--size", "9"}, 1,
                         "the flow grew without bound at time");
  expectFailureLeavesAll({"generate", "cavity,reynolds=0.01,end-time=1000", "x.nrrd", "--size", "9"}, 1,
                         "at most 1000000 time steps");
  expectFailureLeavesAll({"generate", "cavity,reynolds=0.01", "x.nrrd", "--size", "17", "--steps", "9"}, 1,
                         "at most 1000000 time steps");
  expectFailureLeavesAll({"generate", "cavity,end-time=0", "x.nrrd", "--size", "9"}, 1, "expected a positive time");
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "17x17x9"}, 1, "--size");
  expectFailureLeavesAll({"generate", "cavity", "x.png", "--size", "9"}, 1, "x.png");
  expectFailureLeavesAll({"generate", "cavity", "nowhere/x.nrrd", "--size", "9"}, 1, "nowhere");
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "257", "--memory", "1GB"}, 1, "--memory");
  expectFailureLeavesAll({"generate", "cavity", "x", "--size", "9", "--steps", "2"}, 1, "--steps");
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "9", "--steps", "0"}, 2, "--steps");
  expectFailureLeavesAll({"generate", "cavity", "x.nrrd", "--size", "9", "--steps", "2", "--stats", "x_0001.nrrd"}, 1,
                         "x_0001.nrrd: would be written twice");
  expectFailureLeavesAll({"generate", "ball", "x.nrrd", "--size", "9", "--steps", "2"}, 1, "--steps");
  expectFailureLeavesAll({"info", "field:cavity"}, 1, "hbvol generate cavity");
}

TEST_F(generate, InterruptedSimulationsLeaveNothing) {
  hbProgramRun::Conditions interrupt;
  interrupt.interrupt = true;
  expectFailureLeavesAll({"generate", "cavity,tolerance=1e-9", "x.nrrd", "--size", "65"}, 1, "interrupted", interrupt);
}
