#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "raycast/hbInput.h"
#include "tests/apps/hbAppTest.h"
#include "volume/hbLatticeParts.h"
#include "volume/hbSubLattice.h"
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
  EXPECT_EQ(json("s.json")["bytes"], 13 * 10 * 7 * 4);
  EXPECT_GE(json("s.json")["memory_growth_bytes"], 0);
  EXPECT_FALSE(json("s.json").contains("box"));
  EXPECT_FALSE(json("s.json").contains("lod"));
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

TEST_F(extract, SpoilsSamplesWhereAsked) {
  writeVolume<float>("v.nrrd", {20, 20, 20}, 1,
                     [](auto x, auto y, auto z, int) { return double(x + 20 * y + 400 * z); });
  EXPECT_RUNS(run({"extract", "v.nrrd", "e.nrrd", "--outliers", "0.1", "--stats", "s.json"}));
  EXPECT_EQ(json("s.json")["outliers"], 0.1);
  const hbVolume before = hb::readVolume(folder_ / "v.nrrd"), after = hb::readVolume(folder_ / "e.nrrd");
  double spoiled = 0.0;
  for (int z = 0; z < 20; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) spoiled += after.value(x, y, z) != before.value(x, y, z) ? 1.0 : 0.0;
  EXPECT_NEAR(spoiled / 8000.0, 0.1, 5.0 * std::sqrt(0.1 * 0.9 / 8000.0));
}

TEST_F(extract, WritesWhatTheFieldIsInMemory) {
  // One component and several, a flat axis, values that need a map.
  writeVolume<float>("one.nrrd", {33, 20, 17}, 1,
                     [](auto x, auto y, auto z, int) { return std::sin(0.3 * double(x * y + z)); });
  writeVolume<std::int16_t>("three.nrrd", {9, 12, 1}, 3,
                            [](auto x, auto y, auto, int c) { return double(x * x - 7 * y + 100 * c); });
  writeVolume<std::int32_t>("wide.nrrd", {6, 5, 40}, 2,
                            [](auto x, auto y, auto z, int c) { return 1e9 + double(x + 3 * y - z * c); });
  using Lattice = hbSubLattice;
  struct Choice {
    std::vector<std::string> options;
    std::function<Lattice(const Lattice&)> lattice;
  };
  const std::vector<Choice> choices{{{}, [](const Lattice& all) { return all; }},
                                    {{"--box", "2:5,1:4,0:0"},
                                     [](const Lattice& all) {
                                       return all.box({2, 1, 0}, {5, 4, 0});
                                     }},
                                    {{"--lod", "1"}, [](const Lattice& all) { return all.thinned(1); }},
                                    {{"--lod", "15"}, [](const Lattice& all) { return all.thinned(15); }},
                                    {{"--size", "7x11x1"},
                                     [](const Lattice& all) {
                                       return all.resized({7, 11, 1});
                                     }},
                                    {{"--lod", "2", "--box", "0:5,2:4,0:0"},
                                     [](const Lattice& all) {
                                       return all.box({0, 2, 0}, {5, 4, 0}).thinned(2);
                                     }},
                                    {{"--size", "3x5x1", "--box", "1:5,1:4,0:0"}, [](const Lattice& all) {
                                       return all.box({1, 1, 0}, {5, 4, 0}).resized({3, 5, 1});
                                     }}};
  for (const char* name : {"one", "three", "wide"}) {
    const std::string file = std::string(name) + ".hbv";
    EXPECT_RUNS(run({"compress", std::string(name) + ".nrrd", file}));
    const hbInput input = hbInput::open(path(file), {});
    const auto field = input.field(hbEngine::direct);
    for (const Choice& choice : choices) {
      std::vector<std::string> arguments{"extract", file, "e.nrrd"};
      arguments.insert(arguments.end(), choice.options.begin(), choice.options.end());
      EXPECT_RUNS(run(arguments));
      const hbSubLattice lattice = choice.lattice(hbSubLattice(input.geometry()));
      const hbVolume made = hb::readVolume(folder_ / "e.nrrd");
      const hbSize3 size = lattice.size();
      ASSERT_EQ(made.geometry(), lattice.geometry());
      ASSERT_EQ(made.components(), field->components());
      const auto xs = lattice.cubeCoordinates(0), ys = lattice.cubeCoordinates(1), zs = lattice.cubeCoordinates(2);
      for (int c = 0; c < made.components(); ++c) {
        std::vector<float> expected(std::size_t(size.x * size.y * size.z));
        field->lattice(xs, ys, zs, c, expected.data(), xs.size(), xs.size() * ys.size());
        std::size_t i = 0;
        for (std::int64_t z = 0; z < size.z; ++z)
          for (std::int64_t y = 0; y < size.y; ++y)
            for (std::int64_t x = 0; x < size.x; ++x, ++i)
              ASSERT_EQ(made.value(x, y, z, c), field->valueMap().toTrue(expected[i]))
                  << fmt::format("{}", fmt::join(arguments, " "));
      }
    }
  }
}

TEST_F(extract, BoxesAndLevelsOfDetailAreSamplesOfTheVolume) {
  // Random boxes of random volumes: the same values at the same places of the world.
  std::mt19937 random(4);
  const auto below = [&](std::int64_t count) { return std::int64_t(random() % std::uint32_t(count)); };
  for (int round = 0; round < 12; ++round) {
    const hbSize3 size{1 + below(20), 1 + below(20), 1 + below(20)};
    write("v.nhdr", fmt::format("NRRD0005\ntype: uint8\ndimension: 3\nsizes: {} {} {}\nspace dimension: 3\n"
                                "space directions: (0,2,0) (0,0,3) (-4,0,0)\nspace origin: (10,20,30)\n"
                                "encoding: raw\ndata file: v.raw\n",
                                size.x, size.y, size.z));
    std::string samples(std::size_t(size.x * size.y * size.z), '\0');
    for (char& sample : samples) sample = char(below(256));
    write("v.raw", samples);
    hbSize3 first, last, step;
    const int lod = int(below(4));
    for (int d = 0; d < 3; ++d) {
      first[d] = below(size[d]);
      last[d] = first[d] + below(size[d] - first[d]);
      step[d] = std::clamp<std::int64_t>(last[d] - first[d], 1, 1 << lod);
    }
    const std::string box = fmt::format("{}:{},{}:{},{}:{}", first.x, last.x, first.y, last.y, first.z, last.z);
    EXPECT_RUNS(run({"extract", "v.nhdr", "e.nrrd", "--box", box, "--lod", std::to_string(lod), "--stats", "s.json"}));
    EXPECT_EQ(json("s.json")["box"], box);
    EXPECT_EQ(json("s.json")["lod"], lod);
    const hbVolume source = hb::readVolume(folder_ / "v.nhdr"), made = hb::readVolume(folder_ / "e.nrrd");
    ASSERT_EQ(made.geometry().size, (last - first) / step + std::int64_t{1}) << box;
    const auto world = [](const hbVolume& volume, const hbSize3& sample) {
      const hbGeometry& g = volume.geometry();
      return g.origin + g.direction * (g.spacing * glm::dvec3(sample));
    };
    const hbSize3 count = made.geometry().size;
    for (std::int64_t z = 0; z < count.z; ++z)
      for (std::int64_t y = 0; y < count.y; ++y)
        for (std::int64_t x = 0; x < count.x; ++x) {
          const hbSize3 k{x, y, z}, there = first + step * k;
          ASSERT_EQ(made.value(x, y, z), source.value(there.x, there.y, there.z)) << box;
          ASSERT_EQ(world(made, k), world(source, there)) << box; // whole numbers throughout
        }
  }
}

// Few large planes are cut into strips of rows.
TEST_F(extract, StripsOfRowsMakeUpPlanes) {
  writeVolume<float>("v.nrrd", {9, 9, 3}, 2, [](auto x, auto y, auto z, int c) { return double(x * y + z) - 3.0 * c; });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv"}));
  EXPECT_RUNS(run({"extract", "v.hbv", "e.nrrd", "--size", "500x400x3"}));
  const hbInput input = hbInput::open(path("v.hbv"), {});
  const hbSubLattice lattice = hbSubLattice(input.geometry()).resized({500, 400, 3});
  const auto xs = lattice.cubeCoordinates(0), ys = lattice.cubeCoordinates(1), zs = lattice.cubeCoordinates(2);
  ASSERT_GT(hbLatticeParts(xs, ys, zs).count(), 3);
  std::array<std::vector<float>, 2> expected;
  for (int c = 0; c < 2; ++c) {
    expected[std::size_t(c)].resize(500 * 400 * 3);
    input.field(hbEngine::direct)->lattice(xs, ys, zs, c, expected[std::size_t(c)].data(), 500, 500 * 400);
  }
  const hbVolume made = hb::readVolume(folder_ / "e.nrrd");
  std::size_t i = 0, different = 0;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 400; ++y)
      for (int x = 0; x < 500; ++x, ++i)
        for (int c = 0; c < 2; ++c) different += made.value(x, y, z, c) != double(expected[std::size_t(c)][i]) ? 1 : 0;
  EXPECT_EQ(different, 0U);
}

TEST_F(extract, NeedsTheMemoryOfASlab) {
  EXPECT_RUNS(run({"compress", "field:smooth,size=320", "v.hbv", "--level", "3", "--measure", "none"}));
  hbProgramRun::Conditions full;
  full.fileBytes = std::uint64_t{40} << 20; // the second slab does not fit
  expectFailureLeavesAll({"extract", "v.hbv", "e.nrrd", "--size", "320"}, 1, "e.nrrd: cannot be written", full);
  // Two threads: each has memory of its own.
  EXPECT_RUNS(run({"extract", "v.hbv", "e.nrrd", "--size", "320", "--stats", "s.json", "--threads", "2"}));
  EXPECT_EQ(json("s.json")["bytes"], 320 * 320 * 320 * 4);
  // The second slab follows the first: all bytes are those of the field in memory.
  const hbInput input = hbInput::open(path("v.hbv"), {});
  const hbSubLattice lattice = hbSubLattice(input.geometry()).resized({320, 320, 320});
  const auto xs = lattice.cubeCoordinates(0), ys = lattice.cubeCoordinates(1), zs = lattice.cubeCoordinates(2);
  std::vector<float> expected(std::size_t(320) * 320 * 320);
  input.field(hbEngine::direct)->lattice(xs, ys, zs, 0, expected.data(), 320, 320 * 320);
  std::ifstream in(folder_ / "e.nrrd", std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(file.size(), expected.size() * sizeof(float));
  EXPECT_EQ(std::memcmp(file.data() + file.size() - expected.size() * sizeof(float), expected.data(),
                        expected.size() * sizeof(float)),
            0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // their own memory is counted, too
  // 125 MB of samples, a slab of 24 MB, and what the threads' stacks and a row of the grid take.
  EXPECT_LT(json("s.json")["memory_growth_bytes"], std::int64_t{40} << 20);
#endif
}

TEST_F(extract, RefusesBadInputAndSizes) {
  writeVolume<float>("v.nrrd", {3, 3, 3}, 1, [](auto x, auto, auto, int) { return double(x); });
  write("damaged.hbv", "no container at all");
  expectFailureLeavesAll({"extract", "damaged.hbv", "x.nrrd"}, 1, "damaged.hbv");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "0x5x5"}, 1, "--size");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "1048576"}, 1, "2^60");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--sizes", "5"}, 2, "--sizes");
  for (const char* box : {"0:1,0:1", "0:1,0:1,0:1,0:1", "0:1,0:1,0", "a:b,0:1,0:1", "0:1,0:1,-1:1", "0:1,2:1,0:1",
                          "0:1:2,0:1,0:1", "0:1,0:1,", "0 :1,0:1,0:1"})
    expectFailureLeavesAll(
        {"extract", "none.nrrd", "x.nrrd", "--box", box}, 1,
        fmt::format("--box: expected samples from 0 on, first:last, such as 0:64,10:20,5:5, found '{}'", box));
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--box", "0:1,0:3,0:1"}, 1,
                         "v.nrrd: --box: expected first:last from 0:0 to 2:2 along y, found 0:3");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--box", "0:1,0:1,1:1", "--size", "5"}, 1,
                         "v.nrrd: --size: expected 1 along z, where the box has one sample, found 5");
  for (const char* share : {"1.5", "-0.1", "nan"})
    expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--outliers", share}, 2, "--outliers");
  expectFailureLeavesAll(
      {"extract", "field:smooth,size=9", "x.nrrd", "--outliers", "0.1"}, 1,
      "field:smooth,size=9: --outliers: expected a plain volume, whose range is known, found analytic");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--lod", "16"}, 2, "--lod");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--lod", "-1"}, 2, "--lod");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--lod", "1", "--size", "5"}, 2, "--lod");
}
