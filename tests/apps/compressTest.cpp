#include <cmath>
#include <limits>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "sparsegrid/hbSparseGridFile.h"
#include "tests/apps/hbAppTest.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbContainerReader.h"

namespace {

constexpr std::uint64_t kMemory = std::uint64_t{1} << 30;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

} // namespace

class compress : public hbAppTest {
protected:
  hbSparseGridFile read(const std::string& name) const {
    return hbSparseGridFile::read(hbContainerReader(folder_ / name, hbSparseGridFile::chunkTypes(), kMemory));
  }
};

TEST_F(compress, SaysWhatItCostAndLost) {
  writeVolume<std::uint16_t>("v.nrrd", {17, 9, 5}, 1, [](auto x, auto y, auto z, int) {
    return 1000.0 * std::sin(0.3 * double(x + y)) + 2000 + double(z);
  });
  const hbProgramRun done = run({"compress", "v.nrrd", "v.hbv", "--level", "3", "--stats", "s.json"});
  EXPECT_RUNS(done);
  const auto stats = json("s.json");
  const hbSparseGridFile file = read("v.hbv");
  EXPECT_EQ(stats["input_bytes"], std::filesystem::file_size(folder_ / "v.nrrd"));
  EXPECT_EQ(stats["output_bytes"], std::filesystem::file_size(folder_ / "v.hbv"));
  EXPECT_EQ(stats["samples"], 17 * 9 * 5);
  EXPECT_EQ(stats["stored_values"], file.grid.indexSet().storedValues());
  EXPECT_DOUBLE_EQ(stats["bits_per_sample"].get<double>(), 8.0 * stats["output_bytes"].get<double>() / (17 * 9 * 5));
  ASSERT_TRUE(file.error);
  const hbErrorRecord::Component& error = file.error->components.at(0);
  EXPECT_EQ(stats["max_error"], error.max);
  EXPECT_EQ(stats["rmse"], error.rmse);
  EXPECT_EQ(stats["psnr"], error.psnr);
  EXPECT_GT(error.rmse, 0.0);
  EXPECT_TRUE(stats["max_error_bound"].is_null());
  EXPECT_TRUE(stats["seconds"].is_number());
  EXPECT_NE(done.out.find("level 3"), std::string::npos) << done.out;
  // The record is what a comparison of the two finds.
  const auto difference = run({"diff", "v.nrrd", "v.hbv", "--json"}).json();
  EXPECT_EQ(difference["max"], stats["max_error"]);
  EXPECT_EQ(difference["rmse"], stats["rmse"]);
}

TEST_F(compress, ReplacesNonFiniteSamplesOnlyWhenTold) {
  const std::vector<double> bads{kNan, kInfinity, -kInfinity};
  for (const double bad : bads) {
    writeVolume<float>("v.nrrd", {5, 5, 5}, 1,
                       [&](auto x, auto y, auto z, int) { return x == 2 && y == 2 && z == 4 ? bad : double(x); });
    expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv"}, 1, "--nan-value");
    EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--nan-value", "-7", "--index-set", "full"}));
    // Level 2 of 5 samples an axis, every subspace: the grid's nodes are the samples.
    const hbSparseGridFile file = read("v.hbv");
    EXPECT_NEAR(file.grid.calcValue({0.5, 0.5, 1.0}, 0), -7.0, 64 * 0x1p-24);
    EXPECT_NEAR(file.grid.calcValue({0.75, 0.5, 1.0}, 0), 3.0, 64 * 0x1p-24);
    EXPECT_EQ(file.range->components.at(0), (hbRangeRecord::Component{-7.0, 4.0}));
  }
}

TEST_F(compress, RefusesLevelsThereAreNot) {
  for (const char* level : {"0", "-1", "99", "21", "2.5", ""})
    expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", level}, 2, "--level");
}

TEST_F(compress, TakesALevelForEachAxis) {
  writeVolume<float>("v.nrrd", {17, 17, 5}, 1, [](auto x, auto y, auto z, int) { return double(x * y + z); });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--levels-per-axis", "4,2,9", "--stats", "s.json"}));
  const hbSparseGridFile volume = read("v.hbv");
  EXPECT_EQ(volume.grid.indexSet().finest(), glm::ivec3(4, 2, 2)); // z ends where the samples do
  EXPECT_EQ(json("s.json")["stored_values"], volume.grid.indexSet().storedValues());
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--levels-per-axis", "4,2,3", "--uncapped"}));
  EXPECT_EQ(read("v.hbv").grid.indexSet().finest(), glm::ivec3(4, 2, 3));
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--levels-per-axis", "4,2,1", "--index-set", "full"}));
  EXPECT_EQ(read("v.hbv").grid.indexSet().storedValues(), 17 * 5 * 3);
  EXPECT_RUNS(run({"compress", "field:smooth", "f.hbv", "--levels-per-axis", "3,5,2"}));
  const hbSparseGridFile field = read("f.hbv");
  EXPECT_EQ(field.grid.geometry().size, hbSize3(9, 33, 5));
  EXPECT_EQ(field.grid.indexSet().finest(), glm::ivec3(3, 5, 2));

  for (const char* levels : {"0,1,1", "1,1,21", "1,1", "1,1,1,1", "1,1,", "1;1;1", "1,1,x", "1.5,1,1", "5", ""})
    expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--levels-per-axis", levels}, 2, "--levels-per-axis");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", "3", "--levels-per-axis", "3,3,3"}, 2,
                         "--level");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--levels-per-axis", "20,20,20"}, 1, "2^60");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--levels-per-axis", "20,20,18", "--memory", "10MB"}, 1,
                         "memory");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", "20", "--index-set", "full"}, 1, "2^60");
}

TEST_F(compress, TakesAFileOfSubspaces) {
  writeVolume<float>("v.nrrd", {9, 9, 1}, 1, [](auto x, auto y, auto, int) { return double(x * y); });
  write("set.txt", "# a cross\n1 1 1\n2 1 1\n3 1 1\n1 2 1\n");
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--index-set", "set.txt"}));
  const hbSparseGridFile file = read("v.hbv");
  EXPECT_EQ(file.grid.indexSet().storedValues(), 9 * 3 + 3 * 2);
  // Bilinear: without error but for the rounding of a handful of surpluses up to 64.
  EXPECT_LE(file.error->components.at(0).max, 4 * 64 * 0x1p-24);
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--level", "3"}, {"--levels-per-axis", "3,3,3"}, {"--uncapped"}}) {
    std::vector<std::string> line{"compress", "v.nrrd", "x.hbv", "--index-set", "set.txt"};
    line.insert(line.end(), other.begin(), other.end());
    expectFailureLeavesAll(line, 2, "--index-set");
  }
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", "none.txt"}, 1,
                         "--index-set: expected regular, full or a file, found 'none.txt'");
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", ""}, 1, "found ''");
  write("set.txt", "1 1 1\n3 1 1\n");
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", "set.txt"}, 1,
                         "set.txt: line 2: expected (2,1,0), which (3,1,0) needs, found no such line");
  write("set.txt", "1 1 one\n");
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", "set.txt"}, 1, "set.txt: line 1: expected");
  write("set.txt", "1 1 1\n1 1 2\n");
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", "set.txt"}, 1,
                         "set.txt: line 2: expected level 0 or 1 along z, which has one sample, found 2");
  write("set.txt", "1 1 0\n2 1 0\n3 1 0\n4 1 0");
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--index-set", "set.txt", "--mapping", "aligned"}, 1,
                         "levels up to 3 along x");
}

TEST_F(compress, RefusesSizesBeyondAllBounds) {
  write("raw.bin", "1234");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "1048576x1048576x1048576"}, 1, "raw.bin");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "1048576x1048576x1048575"}, 1, "raw.bin");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "0x4x4"}, 1, "--raw-size");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "2x2x2"}, 1, "raw.bin: expected 8 bytes");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "4x1x1", "--raw-type", "int7"}, 1, "int7");
  expectFailureLeavesAll({"compress", "raw.bin", "x.hbv", "--raw-size", "4x1x1", "--raw-spacing", "1,0,1"}, 1,
                         "raw.bin");
  for (const char* sizes : {"1048576 1048576 1048576", "0 4 4", "4 4 -4", "99999999999999999999 1 1"}) {
    write("v.nrrd", fmt::format("NRRD0005\ntype: uint8\ndimension: 3\nsizes: {}\nencoding: raw\n\n1234", sizes));
    expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv"}, 1, "v.nrrd");
  }
  write("v_0x4x4_uint8.raw", "");
  expectFailureLeavesAll({"compress", "v_0x4x4_uint8.raw", "x.hbv"}, 1, "v_0x4x4_uint8.raw");
}

TEST_F(compress, TakesRawSamplesAsTold) {
  // big-endian int16, z fastest, two planar components after 3 bytes of something else.
  std::string raw = "abc";
  for (int c = 0; c < 2; ++c)
    for (int x = 0; x < 2; ++x)
      for (int y = 0; y < 3; ++y)
        for (int z = 0; z < 5; ++z) {
          const int value = 1000 * (c + 1) + 100 * x + 10 * y + z;
          raw += char(value >> 8);
          raw += char(value & 255);
        }
  write("some.bin", raw);
  EXPECT_RUNS(run({"compress", "some.bin",         "v.hbv", "--raw-size",         "2x3x5",  "--raw-type",
                   "int16",    "--raw-byte-order", "big",   "--raw-axis-order",   "zyx",    "--raw-offset",
                   "3",        "--raw-components", "2",     "--raw-interleaving", "planar", "--raw-spacing",
                   "1,2,3",    "--index-set",      "full"}));
  const hbSparseGridFile file = read("v.hbv");
  EXPECT_EQ(file.info.sampleType, hbSampleType::int16);
  EXPECT_EQ(file.grid.geometry().spacing, glm::dvec3(1, 2, 3));
  ASSERT_EQ(file.grid.components(), 2);
  // Linear in x, y and z: stored exactly but for the rounding of a handful of surpluses below 4096.
  for (int c = 0; c < 2; ++c)
    EXPECT_NEAR(file.grid.calcValue({1.0, 0.5, 0.75}, c), 1000 * (c + 1) + 100 + 10 + 3, 8 * 4096 * 0x1p-24);
}

// Rough data, whose nodes say little of the samples between them.
TEST_F(compress, FitsAllSamples) {
  writeVolume<std::uint8_t>("v.nrrd", {33, 33, 17}, 1, [](auto x, auto y, auto z, int) {
    return 100.0 + 50.0 * std::sin(0.2 * double(x + y + z)) + double((x * 97 + y * 57 + z * 31 + x * y * z) % 100);
  });
  EXPECT_RUNS(run({"compress", "v.nrrd", "i.hbv", "--level", "4", "--stats", "i.json"}));
  EXPECT_FALSE(json("i.json").contains("fit"));
  EXPECT_FALSE(run({"info", "i.hbv", "--json"}).json()["provenance"].contains("fit"));
  for (const char* method : {"opticom", "least-squares"}) {
    const hbProgramRun done =
        run({"compress", "v.nrrd", "f.hbv", "--level", "4", "--fit", method, "--loss", "huber", "--stats", "f.json"});
    EXPECT_RUNS(done);
    const auto stats = json("f.json"), fit = stats["fit"].at(0);
    EXPECT_EQ(stats["stored_values"], json("i.json")["stored_values"]);
    EXPECT_LT(stats["rmse"], json("i.json")["rmse"]);
    EXPECT_EQ(fit["method"], method);
    EXPECT_EQ(fit["loss"], "huber");
    EXPECT_GT(fit["loss_threshold"], 0.0);
    EXPECT_EQ(fit["smoothing"].is_null(), std::string_view(method) == "opticom");
    EXPECT_TRUE(fit["improved"].get<bool>());
    EXPECT_TRUE(fit["converged"].get<bool>());
    EXPECT_EQ(fit["samples"].get<int>() + fit["held_out"].get<int>(), 33 * 33 * 17);
    EXPECT_LT(fit["held_out_rmse"], fit["interpolation_held_out_rmse"]);
    EXPECT_GE(fit["condition_estimate"], 1.0);
    for (const char* figure : {"unknowns", "iterations", "rounds", "residual_rmse", "held_out_cost", "seconds"})
      EXPECT_GT(fit[figure], 0.0) << figure;
    EXPECT_NE(done.out.find("samples held out: RMSE"), std::string::npos) << done.out;
    const auto provenance = run({"info", "f.hbv", "--json"}).json()["provenance"]["fit"].at(0);
    EXPECT_EQ(provenance["method"], method);
    EXPECT_EQ(provenance["held_out_rmse"], fit["held_out_rmse"]);
    EXPECT_FALSE(provenance.contains("seconds"));
  }
}

TEST_F(compress, KeepsInterpolationWhereAFitIsNoBetter) {
  writeVolume<float>("v.nrrd", {17, 9, 9}, 1, [](auto x, auto y, auto z, int) { return double(x + 2 * y - z); });
  EXPECT_RUNS(run({"compress", "v.nrrd", "i.hbv"}));
  const hbProgramRun done = run({"compress", "v.nrrd", "f.hbv", "--fit", "least-squares", "--stats", "s.json"});
  EXPECT_RUNS(done);
  EXPECT_FALSE(json("s.json")["fit"].at(0)["improved"].get<bool>());
  EXPECT_NE(done.out.find("no better, interpolation was kept"), std::string::npos) << done.out;
  EXPECT_EQ(json("s.json")["max_error"], 0.0);
}

TEST_F(compress, RefusesFitsThatAreNone) {
  writeVolume<float>("v.nrrd", {33, 6, 9}, 1, [](auto x, auto y, auto z, int) { return double(x * y * z % 7); });
  writeVolume<float>("small.nrrd", {3, 3, 3}, 1, [](auto x, auto, auto, int) { return double(x); });
  const auto refused = [&](std::vector<std::string> options, int code, const char* words) {
    std::vector<std::string> arguments{"compress", "v.nrrd", "x.hbv"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    expectFailureLeavesAll(arguments, code, words);
  };
  refused({"--fit", "magic"}, 2, "--fit: magic not in {interpolation,opticom,least-squares}");
  refused({"--loss", "huber"}, 2, "--loss: expected --fit opticom or least-squares beside it");
  refused({"--fit", "interpolation", "--keep-best"}, 2, "--keep-best: expected --fit");
  refused({"--fit", "opticom", "--smoothing", "1"}, 2, "--smoothing: expected --fit least-squares");
  refused({"--fit", "opticom", "--solver", "auto"}, 2, "--solver: expected --fit least-squares");
  refused({"--fit", "opticom", "--loss-threshold", "1"}, 2, "--loss-threshold: expected --loss huber");
  refused({"--fit", "opticom", "--loss", "huber", "--loss-threshold", "0"}, 2, "--loss-threshold");
  refused({"--fit", "least-squares", "--smoothing", "-1"}, 2, "--smoothing");
  for (const char* number : {"nan", "inf"}) {
    refused({"--fit", "least-squares", "--smoothing", number}, 2, "--smoothing");
    refused({"--fit", "opticom", "--loss", "huber", "--loss-threshold", number}, 2, "--loss-threshold");
  }
  expectFailureLeavesAll({"compress", "field:hydrogen", "x.hbv", "--level", "12", "--fit", "opticom"}, 1,
                         "fit: expected 2147483648 samples at most");
  refused({"--fit", "least-squares", "--smoothing", "0"}, 1,
          "v.nrrd: smoothing: expected more than 0, found 0: along y the grid has more nodes than its 6 samples");
  refused({"--fit", "least-squares", "--memory", "20kb"}, 1, "more than the memory limit");
  expectFailureLeavesAll({"compress", "small.nrrd", "x.hbv", "--fit", "opticom"}, 1,
                         "small.nrrd: fit: expected 1024 samples at least");
  expectFailureLeavesAll({"compress", "x.hbv", "--components", "v_{i}_{j}_{k}.nrrd", "--fit", "opticom"}, 2, "--fit");
}

// A threshold far below the noise makes for many rounds.
TEST_F(compress, InterruptedKeepsTheBestFitOnlyIfAsked) {
  writeVolume<float>("v.nrrd", {65, 65, 65}, 1,
                     [](auto x, auto y, auto z, int) { return double((x * 7919 + y * 104729 + z * 1299709) % 1009); });
  hbProgramRun::Conditions interrupt;
  interrupt.interrupt = true;
  std::vector<std::string> arguments{"compress", "v.nrrd", "x.hbv",   "--fit", "least-squares",
                                     "--loss",   "huber",  "--level", "6",     "--loss-threshold",
                                     "1e-7"};
  expectFailureLeavesAll(arguments, 1, "interrupted", interrupt);
  arguments.insert(arguments.end(), {"--keep-best", "--stats", "s.json"});
  EXPECT_RUNS(run(arguments, interrupt));
  EXPECT_TRUE(json("s.json")["fit"].at(0)["interrupted"].get<bool>());
  EXPECT_TRUE(json("s.json")["rmse"].is_number());
  EXPECT_EQ(read("x.hbv").grid.geometry().size, hbSize3(65));
}

TEST_F(compress, ASparseGridIsNoInput) {
  EXPECT_RUNS(run({"compress", "field:ball", "b.hbv", "--level", "2"}));
  expectFailureLeavesAll({"compress", "b.hbv", "x.hbv"}, 1, "sparse grid");
  expectFailureLeavesAll({"compress", "b.hbv"}, 2, "OUT");
  // Not even onto itself.
  expectFailureLeavesAll({"compress", "b.hbv", "b.hbv"}, 1, "sparse grid");
}

TEST_F(compress, MeasuresWhatItIsTold) {
  writeVolume<float>("v.nrrd", {33, 33, 33}, 1, [](auto x, auto y, auto z, int) { return double((x * y * z) % 17); });
  const auto reference = [&](const char* measure) {
    EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--level", "3", "--measure", measure, "--stats", "s.json"}));
    return run({"info", "v.hbv", "--json"}).json();
  };
  const auto all = reference("all"), automatic = reference("auto"), sampled = reference("sampled");
  EXPECT_EQ(all["errors"], automatic["errors"]);
  EXPECT_EQ(all["errors"][0]["against"], "all samples");
  EXPECT_EQ(all["errors"][0]["points"], 33 * 33 * 33);
  EXPECT_EQ(sampled["errors"][0]["against"], "random samples");
  EXPECT_EQ(sampled["errors"][0]["points"], 1 << 17);
  // 29 draws a sample: the maximum over them is all but certain to be that over all, and the seed is fixed.
  EXPECT_EQ(sampled["errors"][0]["max"], all["errors"][0]["max"]);
  EXPECT_FALSE(reference("none").contains("errors"));
  EXPECT_TRUE(json("s.json")["psnr"].is_null());
}

TEST_F(compress, ReadsALargeFileInLittleMemory) {
  // 8 GB that take no disk: a sparse file with a few bytes in it.
  constexpr std::int64_t kSide = 2049;
  const std::string name = "large_2049x2049x2049_uint8.raw";
  write(name, "");
  std::filesystem::resize_file(folder_ / name, std::uintmax_t(kSide * kSide * kSide));
  const int file = ::open(path(name).c_str(), O_WRONLY);
  ASSERT_GE(file, 0);
  const auto poke = [&](std::int64_t x, std::int64_t y, std::int64_t z, unsigned char value) {
    ASSERT_EQ(::pwrite(file, &value, 1, x + kSide * (y + kSide * z)), 1);
  };
  poke(0, 0, 0, 200);
  poke(1024, 1024, 1024, 100);
  poke(2048, 2048, 2048, 50);
  ::close(file);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  // A sanitizer's own memory is counted, too, and a million page faults take it half a minute.
  constexpr bool kSanitized = true;
#else
  constexpr bool kSanitized = false;
#endif
  const hbProgramRun done =
      run({"compress", name, "l.hbv", "--level", "11", "--stats", "s.json", "--measure", kSanitized ? "none" : "auto"});
  EXPECT_RUNS(done);
  if (!kSanitized) {
    EXPECT_LT(done.peakBytes, std::int64_t{100} << 20);
  }
  EXPECT_EQ(json("s.json")["stored_values"], 262145);
  EXPECT_EQ(json("s.json")["samples"], kSide * kSide * kSide);
  const hbSparseGridFile grid = read("l.hbv");
  // The nodes' values, apart from the rounding of the surpluses on the way.
  EXPECT_NEAR(grid.grid.calcValue({0, 0, 0}, 0), 200.0, 1e-3);
  EXPECT_NEAR(grid.grid.calcValue({0.5, 0.5, 0.5}, 0), 100.0, 1e-3);
  EXPECT_NEAR(grid.grid.calcValue({1, 1, 1}, 0), 50.0, 1e-3);
  EXPECT_NEAR(grid.grid.calcValue({0, 1, 0.5}, 0), 0.0, 1e-3);
}

TEST_F(compress, BuildsFromComponentGrids) {
  // What a solver that is exact at its nodes would write; files of 0 coefficient are left out.
  const auto field = hbAnalyticField::create("smooth");
  const hbIndexSet set = hbIndexSet::regular(4, {});
  for (const auto& grid : set.componentGrids())
    writeVolume<float>(fmt::format("u_{}_{}_{}.nrrd", grid.levels.x, grid.levels.y, grid.levels.z), grid.nodes, 1,
                       [&](auto x, auto y, auto z, int) {
                         return field->value(glm::dvec3(x, y, z) / glm::dvec3(grid.nodes - std::int64_t(1)));
                       });
  const std::string pattern = "u_{i}_{j}_{k}.nrrd";
  EXPECT_RUNS(run({"compress", "--components", pattern, "u.hbv"}));
  EXPECT_RUNS(run({"compress", "field:smooth", "direct.hbv", "--level", "4"}));
  const hbSparseGrid built = read("u.hbv").grid, direct = read("direct.hbv").grid;
  ASSERT_EQ(built.indexSet().storedValues(), direct.indexSet().storedValues());
  EXPECT_EQ(built.geometry().size, direct.geometry().size);
  // Nodal values below 2 rounded to floats; a surplus weighs 27 of them by at most 8 in all, in each of up to
  // three kinds of grids whose coefficients' sizes sum to less than 40 a subspace.
  for (std::int64_t i = 0; i < direct.indexSet().storedValues(); ++i)
    ASSERT_NEAR(built.surpluses(0)[std::size_t(i)], direct.surpluses(0)[std::size_t(i)], 40 * 8 * 2 * 0x1p-24) << i;

  // What may go wrong.
  EXPECT_FAILS(run({"compress", "--components", "u_{i}_{j}.nrrd", "x.hbv"}), 1, "{k}");
  EXPECT_FAILS(run({"compress", "--components", "w_{i}_{j}_{k}.nrrd", "x.hbv"}), 1, "found none");
  EXPECT_FAILS(run({"compress", "--components", "none/u_{i}_{j}_{k}.nrrd", "x.hbv"}), 1, "found none");
  EXPECT_FAILS(run({"compress", "--components", pattern, "in.nrrd", "x.hbv"}), 2, "--components");
  std::filesystem::rename(folder_ / "u_2_2_2.nrrd", folder_ / "kept.nrrd");
  expectFailureLeavesAll({"compress", "--components", pattern, "u.hbv"}, 1, "found none");
  writeVolume<float>("u_2_2_2.nrrd", {5, 5, 4}, 1, [](auto, auto, auto, int) { return 0.0; });
  expectFailureLeavesAll({"compress", "--components", pattern, "u.hbv"}, 1, "u_2_2_2.nrrd: expected 5 x 5 x 5");
  writeVolume<float>("u_2_2_2.nrrd", {5, 5, 5}, 1, [](auto, auto, auto, int) { return kNan; });
  expectFailureLeavesAll({"compress", "--components", pattern, "u.hbv"}, 1, "finite");
}
