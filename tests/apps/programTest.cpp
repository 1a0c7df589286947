// What holds for every subcommand: help, usage, threads, memory, and what bad input does.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include "tests/apps/hbAppTest.h"

class program : public hbAppTest {};

namespace {

struct Subcommand {
  std::string name;
  std::vector<std::string> options;      ///< Some that its help must name.
  std::vector<std::string> badOption;    ///< A command line of wrong usage...
  std::string badOptionWords;            ///< ... and what the message says.
  std::vector<std::string> missingInput; ///< A command line whose input is no file.
};

const std::vector<Subcommand>& subcommands() {
  static const std::vector<Subcommand> list{
      {"info",
       {"--json", "--verify", "--histogram", "--level", "--uncapped", "--index-set", "--series", "--nan-value",
        "--raw-size"},
       {"info", "field:ball", "--level", "99"},
       "--level",
       {"info", "none.nrrd"}},
      {"generate",
       {"--size", "hydrogen", "marschner-lobb", "multilinear"},
       {"generate", "ball", "x.nrrd", "--threads", "0"},
       "--threads",
       {"generate", "none", "x.nrrd"}},
      {"compress",
       {"--level", "--levels-per-axis", "--uncapped", "--mapping", "--index-set", "--components", "--measure",
        "--raw-type"},
       {"compress", "field:ball", "x.hbv", "--mapping", "loose"},
       "--mapping",
       {"compress", "none.nrrd", "x.hbv"}},
      {"extract",
       {"--box", "--lod", "--size", "--raw-offset"},
       {"extract", "field:ball"},
       "OUT",
       {"extract", "none.hbv", "x.nrrd"}},
      {"render",
       {"--mode",         "--engine",         "--size",        "--iso",          "--component",   "--window",
        "--colormap",     "--azimuth",        "--elevation",   "--zoom",         "--projection",  "--camera",
        "--scene",        "--save-scene",     "--samples",     "--sampling",     "--supersample", "--repeat",
        "--transfer",     "--transfer-range", "--unit-length", "--preintegrate", "--background",  "--gl",
        "--gl-form",      "--gl-textures",    "--gl-target",   "--gl-layout",    "--gl-order",    "--gl-filter",
        "--gl-read-back", "--texture-memory", "--stream"},
       {"render", "field:ball", "x.exr", "--mode", "best"},
       "--mode",
       {"render", "none.hbv", "x.exr"}},
      {"probe",
       {"--points", "--space", "--engine", "--component"},
       {"probe", "field:ball"},
       "--points",
       {"probe", "none.hbv", "--points", "none.txt"}},
      {"diff",
       {"--json", "--component", "--points", "--out", "--fail-above"},
       {"diff", "field:ball", "field:ball", "--points", "0"},
       "--points",
       {"diff", "none.exr", "field:ball"}},
      {"compare",
       {"--out", "--levels", "--engines", "--modes", "--size", "--samples", "--sampling", "--repeat", "--restart",
        "--max-error", "--max-seconds", "--max-bytes", "--transfer", "--component"},
       {"compare", "field:ball", "--out", "x", "--levels", "7..5"},
       "--levels",
       {"compare", "none.nrrd", "--out", "x"}}};
  return list;
}

} // namespace

TEST_F(program, SaysItsVersionAndItsSubcommands) {
  const hbProgramRun version = run({"--version"});
  EXPECT_RUNS(version);
  EXPECT_EQ(version.out, "hbvol " HBVOL_VERSION "\n");
  const hbProgramRun help = run({"--help"});
  EXPECT_RUNS(help);
  for (const Subcommand& subcommand : subcommands())
    EXPECT_NE(help.out.find("\n  " + subcommand.name + " "), std::string::npos) << help.out;
}

TEST_F(program, HelpNamesTheOptions) {
  for (const Subcommand& subcommand : subcommands()) {
    const hbProgramRun help = run({subcommand.name, "--help"});
    EXPECT_RUNS(help);
    for (const std::string& option : subcommand.options)
      EXPECT_NE(help.out.find(option), std::string::npos) << subcommand.name << " " << option;
    for (const char* common : {"--threads", "--memory", "--stats"})
      EXPECT_NE(help.out.find(common), std::string::npos) << subcommand.name << " " << common;
  }
}

TEST_F(program, WrongUsageExitsWithTwo) {
  expectFailureLeavesAll({}, 2, "subcommand");
  expectFailureLeavesAll({"compact"}, 2, "compact");
  expectFailureLeavesAll({"info", "field:ball", "one", "two"}, 2, "one");
  expectFailureLeavesAll({"info", "field:ball", "--memory", "much"}, 2, "--memory");
  for (const Subcommand& subcommand : subcommands()) {
    expectFailureLeavesAll(subcommand.badOption, 2, subcommand.badOptionWords);
    expectFailureLeavesAll({subcommand.name, "--no-such-option"}, 2, "");
  }
}

TEST_F(program, MissingInputsAreNamed) {
  for (const Subcommand& subcommand : subcommands()) expectFailureLeavesAll(subcommand.missingInput, 1, "none");
}

TEST_F(program, FoldersEmptyFilesAndPipesAreNoVolumes) {
  std::filesystem::create_directory(folder_ / "folder");
  std::filesystem::create_directory(folder_ / "folder.hbv");
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(path("pipe.nrrd").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(path("pipe.hbv").c_str(), 0600), 0);
  write("empty.hbv", "");
  write("empty.nrrd", "");
  write("empty_2x2x2_uint8.raw", "");
  write("text.txt", "no volume\n");
  for (const char* name : {"folder", "folder.hbv", "pipe", "pipe.nrrd", "pipe.hbv", "empty.hbv", "empty.nrrd",
                           "empty_2x2x2_uint8.raw", "text.txt", "/dev/null", "/dev/zero"})
    expectFailureLeavesAll({"info", name}, 1, name);
  for (const char* name : {"empty.exr", "empty.png"}) {
    write(name, "");
    expectFailureLeavesAll({"diff", name, name}, 1, name);
  }
}

TEST_F(program, ErrorsAreOneLineWhateverTheName) {
  EXPECT_FAILS(run({"info", "two\nlines.nrrd"}), 1, "lines.nrrd");
  EXPECT_FAILS(run({"info", "field:ball", "two\nlines"}), 2, "lines");
  EXPECT_FAILS(run({"info", ""}), 1, "");
}

TEST_F(program, OutputHasNoWrongExtension) {
  write("points.txt", "0 0 0\n");
  expectFailureLeavesAll({"compress", "field:ball", "x.nrrd", "--level", "2"}, 1, "x.nrrd: expected a name");
  expectFailureLeavesAll({"extract", "field:ball", "x.hbv", "--size", "3"}, 1, "x.hbv");
  expectFailureLeavesAll({"extract", "field:ball", "x.raw", "--size", "3"}, 1, "x.raw");
  expectFailureLeavesAll({"generate", "ball", "x.txt", "--size", "3"}, 1, "x.txt");
  expectFailureLeavesAll({"render", "field:ball", "x.jpg"}, 1, "x.jpg: expected a name");
}

TEST_F(program, TargetsThatCannotBeWrittenAreRefused) {
  write("file", "a file\n");
  std::filesystem::create_directory(folder_ / "folder.exr");
  std::filesystem::create_directory(folder_ / "folder.hbv");
  std::filesystem::create_directory(folder_ / "folder.nrrd");
  const std::vector<std::string> small{"--level", "2"}, tiny{"--size", "8x8"};
  for (const std::string& place : {std::string("none/"), std::string("file/"), std::string("folder")}) {
    expectFailureLeavesAll({"compress", "field:ball", place + (place == "folder" ? ".hbv" : "x.hbv"), "--level", "2"},
                           1, place);
    expectFailureLeavesAll({"generate", "ball", place + (place == "folder" ? ".nrrd" : "x.nrrd"), "--size", "3"}, 1,
                           place);
    expectFailureLeavesAll({"render", "field:ball", place + (place == "folder" ? ".exr" : "x.exr"), "--size", "8x8"}, 1,
                           place);
  }
  expectFailureLeavesAll({"render", "field:ball", "none/x.png", "--size", "8x8"}, 1, "none/x.png");
  expectFailureLeavesAll({"info", "field:ball", "--stats", "none/x.json"}, 1, "none/x.json");
  // /dev/full itself has no extension: through links with one.
  for (const char* link : {"full.hbv", "full.nrrd", "full.exr", "full.png", "full.json"})
    std::filesystem::create_symlink("/dev/full", folder_ / link);
  expectFailureLeavesAll({"compress", "field:ball", "full.hbv", "--level", "2"}, 1,
                         "full.hbv: expected a regular file");
  expectFailureLeavesAll({"generate", "ball", "full.nrrd", "--size", "3"}, 1, "full.nrrd: expected a regular file");
  expectFailureLeavesAll({"render", "field:ball", "full.exr", "--size", "8x8"}, 1, "full.exr: expected a regular file");
  expectFailureLeavesAll({"render", "field:ball", "full.png", "--size", "8x8"}, 1, "full.png: expected a regular file");
  expectFailureLeavesAll({"info", "field:ball", "--stats", "full.json"}, 1, "full.json: expected a regular file");
}

TEST_F(program, FullDisksLeaveTheOldFile) {
  for (const char* name : {"x.hbv", "x.nrrd", "x.exr", "x.png", "x.json"}) write(name, "old\n");
  hbProgramRun::Conditions full;
  full.fileBytes = 100; // less than any of the outputs
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", "3"}, 1, "x.hbv", full);
  expectFailureLeavesAll({"generate", "ball", "x.nrrd", "--size", "9"}, 1, "x.nrrd", full);
  expectFailureLeavesAll({"extract", "field:ball", "x.nrrd", "--size", "9"}, 1, "x.nrrd", full);
  expectFailureLeavesAll({"render", "field:ball", "x.exr", "--size", "32x32"}, 1, "x.exr", full);
  expectFailureLeavesAll({"render", "field:ball", "x.png", "--size", "64x64"}, 1, "x.png", full);
  expectFailureLeavesAll({"info", "field:ball", "--stats", "x.json"}, 1, "x.json", full);
}

TEST_F(program, MemoryIsCheckedBeforeWorkStarts) {
  writeVolume<float>("v.nrrd", {9, 9, 9}, 1, [](auto x, auto y, auto z, int) { return double(x * y * z); });
  EXPECT_RUNS(run({"compress", "v.nrrd", "v.hbv", "--level", "3"}));
  expectFailureLeavesAll({"compress", "v.nrrd", "x.hbv", "--level", "3", "--memory", "1kB"}, 1, "memory");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", "20", "--memory", "10MB"}, 1, "2^60");
  expectFailureLeavesAll({"compress", "field:ball", "x.hbv", "--level", "19", "--memory", "10MB"}, 1, "memory");
  expectFailureLeavesAll({"info", "v.hbv", "--memory", "64"}, 1, "v.hbv");
  expectFailureLeavesAll({"render", "v.hbv", "x.exr", "--memory", "1kB"}, 1, "");
  expectFailureLeavesAll({"render", "v.nrrd", "x.exr", "--memory", "1kB"}, 1, "--memory");
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "2000", "--memory", "1MB"}, 1, "--memory");
  expectFailureLeavesAll({"generate", "ball", "x.nrrd", "--size", "2000", "--memory", "1MB"}, 1, "--memory");
  // A row of 2^40 samples is beyond any machine.
  expectFailureLeavesAll({"extract", "v.nrrd", "x.nrrd", "--size", "1099511627776x1x2"}, 1, "memory");
}

TEST_F(program, StatisticsHaveVersionAndCommand) {
  writeVolume<float>("v.nrrd", {3, 3, 3}, 1, [](auto x, auto y, auto z, int) { return double(x + y + z); });
  write("points.txt", "0.5 0.5 0.5\n");
  const std::vector<std::vector<std::string>> commands{{"info", "v.nrrd"},
                                                       {"generate", "ball", "g.nrrd", "--size", "3"},
                                                       {"compress", "v.nrrd", "v.hbv"},
                                                       {"extract", "v.hbv", "e.nrrd"},
                                                       {"render", "v.hbv", "r.exr", "--size", "8x8"},
                                                       {"probe", "v.hbv", "--points", "points.txt"},
                                                       {"diff", "v.nrrd", "v.hbv"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--stats", "s.json"});
    EXPECT_RUNS(run(command));
    const auto stats = json("s.json");
    EXPECT_EQ(stats.value("version", ""), HBVOL_VERSION);
    EXPECT_EQ(stats.value("command", ""), fmt::format("hbvol {}", fmt::join(command, " ")));
    std::filesystem::remove(folder_ / "s.json");
  }
}

TEST_F(program, FilesAndPicturesDoNotDependOnThreads) {
  // Nothing below is a multiple of a tile, a slab or a part.
  for (const char* threads : {"1", "2", "7"}) {
    const std::string t(threads);
    EXPECT_RUNS(run({"compress", "field:marschner-lobb", "v" + t + ".hbv", "--level", "5", "--threads", t}));
    EXPECT_RUNS(run({"extract", "v1.hbv", "e" + t + ".nrrd", "--size", "13x17x11", "--threads", t}));
    for (const char* engine : {"direct", "seminodal", "combination"})
      for (const char* mode : {"xray", "iso"})
        EXPECT_RUNS(run({"render", "v1.hbv", fmt::format("{}-{}-{}.exr", engine, mode, t), "--engine", engine, "--mode",
                         mode, "--size", "37x23", "--samples", "21", "--threads", t}));
    if (t == "1") continue;
    EXPECT_EQ(bytes("v1.hbv"), bytes("v" + t + ".hbv"));
    EXPECT_EQ(bytes("e1.nrrd"), bytes("e" + t + ".nrrd"));
    for (const char* engine : {"direct", "seminodal", "combination"})
      for (const char* mode : {"xray", "iso"})
        EXPECT_EQ(bytes(fmt::format("{}-{}-1.exr", engine, mode)), bytes(fmt::format("{}-{}-{}.exr", engine, mode, t)));
  }
}

TEST_F(program, InterruptsEndItAndLeaveTheOldFile) {
  for (const char* name : {"x.hbv", "x.exr", "x.nrrd"}) write(name, "old\n");
  EXPECT_RUNS(run({"compress", "field:vortex", "v.hbv", "--level", "9", "--measure", "none"}));
  hbProgramRun::Conditions interrupt;
  interrupt.interrupt = true;
  // Each would take many seconds.
  const std::vector<std::vector<std::string>> commands{
      {"compress", "field:hydrogen", "x.hbv", "--level", "17"},
      {"render", "v.hbv", "x.exr", "--size", "4000x4000", "--samples", "4000"},
      {"render", "v.hbv", "x.exr", "--size", "4000x4000", "--samples", "4000", "--engine", "combination"},
      {"extract", "v.hbv", "x.nrrd", "--size", "1500"}};
  const auto before = contents();
  for (const auto& command : commands) {
    const hbProgramRun stopped = run(command, interrupt);
    EXPECT_FAILS(stopped, 1, "hbvol: error: interrupted; nothing was written");
    EXPECT_LT(stopped.secondsAfterInterrupt, 5.0) << stopped.text();
    EXPECT_TRUE(contents() == before) << names(contents());
  }
}
