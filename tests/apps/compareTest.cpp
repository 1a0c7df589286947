#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "report/hbComparisonFolder.h"
#include "report/hbExternalProgram.h"
#include "scene/hbPictureFile.h"
#include "tests/apps/hbAppTest.h"
#include "tests/apps/hbChildProcess.h"

namespace fs = std::filesystem;

class compare : public hbAppTest {
protected:
  /// Small pictures of a small field; OpenGL is left to tests of its own.
  static std::vector<std::string> arguments(std::vector<std::string> more = {}) {
    std::vector<std::string> all{"compare",   "field:hydrogen,size=17",
                                 "--out",     "out",
                                 "--levels",  "2..3",
                                 "--engines", "seminodal,lattice",
                                 "--size",    "16x12",
                                 "--samples", "8",
                                 "--repeat",  "2",
                                 "--no-peers"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  static constexpr std::size_t kCases = 4 * (1 + 2 * 3); // modes x (volume, and of both levels two engines and a grid)

  std::size_t records() const {
    std::size_t count = 0;
    if (fs::exists(folder_ / "out" / "records"))
      for (const auto& entry : fs::directory_iterator(folder_ / "out" / "records"))
        count += entry.path().extension() == ".json" && entry.path().filename().string().front() != '.' ? 1 : 0;
    return count;
  }

  /// What the checker of pages says of this one: nothing.
  std::string faultsOfPage() const {
    const auto python = hbExternalProgram::find("python3");
    if (!python) return "python3 is missing";
    const auto result = python->run({HBVOL_CHECK_PAGE, path("out/index.html"), path("out/report.json")});
    return result.status == 0 ? "" : result.output + result.errors;
  }
};

TEST_F(compare, MakesOnePageOfEverything) {
  const hbProgramRun found = run(arguments({"--stats", "s.json", "--max-error", "5", "--max-seconds", "10"}));
  EXPECT_RUNS(found);
  for (const char* words : {"the volume itself", "sparse grid, level 3", "full grid of", "for max error <= 5:",
                            "for a frame of iso <= 1e+04 ms: the volume itself by full", "out/index.html"})
    EXPECT_NE(found.out.find(words), std::string::npos) << words << "\n" << found.out;
  const auto report = json("out/report.json");
  ASSERT_EQ(report["cases"].size(), kCases);
  for (const auto& one : report["cases"]) EXPECT_EQ(one["status"], "done") << one;
  EXPECT_EQ(report["runs"], 1);
  EXPECT_NE(report["command"].get<std::string>().find("compare field:hydrogen,size=17"), std::string::npos);
  EXPECT_EQ(report["version"], HBVOL_VERSION);
  EXPECT_EQ(json("s.json")["recommendations"], report["recommendations"]);
  EXPECT_EQ(faultsOfPage(), "");
  EXPECT_TRUE(fs::exists(folder_ / "out" / report["plots"]["error_time"]["iso"].get<std::string>()));
  EXPECT_EQ(hb::readPng(folder_ / "out" / "pictures" / "sparse-3-lattice-dvr.png").height, 12);
  // A row a case, and the header.
  const auto table = bytes("out/report.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), std::byte('\n')), std::ptrdiff_t(kCases + 1));
  // What was compressed is there to be used.
  EXPECT_RUNS(run({"info", "out/choices/sparse-3.hbv", "--verify"}));
}

TEST_F(compare, SetsFitsBesideInterpolation) {
  const auto more = [](const char* fits) { return arguments({"--modes", "mip", "--fits", fits, "--loss", "huber"}); };
  const hbProgramRun found = run(more("least-squares,interpolation,opticom"));
  EXPECT_RUNS(found);
  for (const char* words :
       {"sparse grid, level 3", "opticom, level 3", "least squares, level 3", "for a fit by opticom: "})
    EXPECT_NE(found.out.find(words), std::string::npos) << words << "\n" << found.out;
  const auto report = json("out/report.json");
  EXPECT_EQ(report["settings"]["fits"], (nlohmann::ordered_json{"opticom", "least-squares"}));
  ASSERT_EQ(report["cases"].size(), 11U); // of both levels two engines and a grid, and one engine a fit
  for (const auto& one : report["cases"]) EXPECT_EQ(one["status"], "done") << one;
  EXPECT_EQ(faultsOfPage(), "");
  const auto table = bytes("out/report.csv");
  const std::string text(reinterpret_cast<const char*>(table.data()), table.size());
  EXPECT_NE(text.substr(0, text.find('\n')).find("choice_fit_held_out_rmse"), std::string::npos);
  EXPECT_RUNS(run({"info", "out/choices/least-squares-3.hbv", "--verify"}));

  // The same fits in another order are the same comparison, others another one.
  EXPECT_RUNS(run(more("opticom,least-squares")));
  EXPECT_EQ(json("out/report.json")["runs"], 1);
  expectFailureLeavesAll(more("opticom"), 1, "expected fits");
  expectFailureLeavesAll(arguments({"--modes", "mip"}), 1, "found none");
}

TEST_F(compare, GoesOnAfterItWasKilled) {
  {
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    hbChildProcess child(arguments(), {folder_.path().string(), nothing, nothing, {}});
    while (records() < 5 && child.running()) ::usleep(200);
    child.signal(SIGKILL);
    child.wait();
    ::close(nothing);
  }
  const std::size_t before = records();
  EXPECT_RUNS(run(arguments()));
  const auto report = json("out/report.json");
  ASSERT_EQ(report["cases"].size(), kCases);
  std::size_t first = 0;
  for (const auto& one : report["cases"]) {
    EXPECT_EQ(one["status"], "done") << one;
    first += one["run"] == 1 ? 1U : 0U;
  }
  // The records are those of the cases, and of the choices they belong to.
  EXPECT_LE(first, before);
  EXPECT_GE(first + report["choices"].size(), std::min(before, std::size_t(5)));
  EXPECT_EQ(faultsOfPage(), "");
}

TEST_F(compare, SaysWhatIsInterruptedAndKeepsIt) {
  hbProgramRun::Conditions conditions;
  conditions.interrupt = true;
  const hbProgramRun found =
      run({"compare", "field:hydrogen,size=17", "--out", "out", "--repeat", "10000"}, conditions);
  EXPECT_FAILS(found, 1, "interrupted; what was measured is kept in out");
  EXPECT_FALSE(fs::exists(folder_ / "out" / "report.json"));
}

TEST_F(compare, RefusesAnotherComparisonInItsFolder) {
  EXPECT_RUNS(run(arguments({"--modes", "mip"})));
  expectFailureLeavesAll(arguments({"--modes", "mip", "--iso", "3"}), 1, "--restart");
  expectFailureLeavesAll(arguments({"--modes", "xray"}), 1, "modes");
  EXPECT_RUNS(run(arguments({"--modes", "xray", "--restart"})));
  EXPECT_EQ(json("out/report.json")["runs"], 1);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "pictures" / "sparse-3-lattice-mip.png"));
  write("note.txt", "mine");
  expectFailureLeavesAll({"compare", "field:ball,size=9", "--out", ".", "--restart"}, 1, "other files");
}

TEST_F(compare, ACaseThatFailsDoesNotEndTheRest) {
  // Extracting 33^3 floats does not fit; neither does the volume as it is, which is only sampled once.
  const hbProgramRun found =
      run({"compare", "field:hydrogen,size=33", "--out", "out", "--levels", "2..2", "--engines", "full,seminodal",
           "--modes", "mip", "--size", "16x12", "--memory", "143748", "--no-peers"});
  EXPECT_EQ(found.exitCode, 0) << found.text();
  const auto report = json("out/report.json");
  ASSERT_EQ(report["cases"].size(), 4U);
  EXPECT_EQ(report["cases"][1]["key"], "sparse-2-full-mip");
  EXPECT_EQ(report["cases"][1]["status"], "failed");
  EXPECT_EQ(report["cases"][2]["status"], "done");
  EXPECT_NE(found.out.find("cases failed"), std::string::npos) << found.out;
  EXPECT_EQ(faultsOfPage(), "");
}

TEST_F(compare, MeasuresHardCasesWhereAsked) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "minutes of OpenGL; tests/hard_cases has them one by one";
#endif
  const hbProgramRun found = run(arguments({"--modes", "mip", "--hard-cases"}));
  EXPECT_RUNS(found);
  const auto report = json("out/report.json");
  std::size_t done = 0, within = 0;
  for (const auto& one : report["hard_cases"]["cases"])
    for (const auto& result : one["results"]) {
      if (result["status"] != "done") continue;
      ++done;
      within += result["within_bound"] ? 1 : 0;
      EXPECT_FALSE(result["exceeds_bound"]) << one["name"] << result;
      EXPECT_NE(result["within_bound"], result["says_nothing"]) << one["name"] << result;
    }
  EXPECT_GT(within, 100U);
  EXPECT_NE(found.out.find(fmt::format("hard cases: {} of {} results are within their bounds, 0 beyond; {} bounds make "
                                       "no statement; ",
                                       within, done, done - within)),
            std::string::npos)
      << found.out;
  EXPECT_EQ(faultsOfPage(), "");

  // What failed is measured again, what did not is taken as it was kept.
  for (const auto& [name, status] : {std::pair("spikes", "failed"), std::pair("level-1", "done")}) {
    auto record = json(fmt::format("out/records/hard-{}.json", name));
    record["why"] = "kept";
    record["results"][0]["status"] = status;
    hb::writeJson(record, path(fmt::format("out/records/hard-{}.json", name)));
  }
  EXPECT_RUNS(run(arguments({"--modes", "mip", "--hard-cases"})));
  std::vector<std::string> kept;
  const auto again = json("out/report.json");
  for (const auto& one : again["hard_cases"]["cases"])
    if (one["why"] == "kept") kept.push_back(one["name"]);
  EXPECT_EQ(kept, std::vector<std::string>{"level-1"});
}

TEST_F(compare, TakesTheSceneOfAFile) {
  EXPECT_RUNS(run({"render", "field:hydrogen,size=17", "x.exr", "--mode", "iso", "--iso", "2", "--size", "20x10",
                   "--samples", "9", "--azimuth", "70", "--save-scene", "s.json"}));
  EXPECT_RUNS(run({"compare", "field:hydrogen,size=17", "--out", "out", "--levels", "2", "--engines", "direct",
                   "--modes", "iso", "--scene", "s.json", "--no-peers"}));
  const auto report = json("out/report.json");
  EXPECT_EQ(report["settings"]["width"], 20);
  EXPECT_EQ(report["settings"]["samples"], 9);
  EXPECT_EQ(report["settings"]["sampling"], "equidistant");
  // The field itself is drawn by that scene.
  EXPECT_EQ(run({"diff", "x.exr", "out/pictures/true-iso.exr", "--json"}).json()["max"], 0.0);
}

TEST_F(compare, RefusesBadOptionsAndFiles) {
  writeVolume<float>("two.nrrd", {5, 5, 5}, 2, [](auto x, auto, auto, int) { return double(x); });
  EXPECT_RUNS(run({"compress", "two.nrrd", "two.hbv"}));
  expectFailureLeavesAll({"compare", "two.hbv", "--out", "o"}, 1, "found a sparse grid");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--component", "2"}, 1, "component");
  expectFailureLeavesAll({"compare", "none.nrrd", "--out", "o"}, 1, "none.nrrd");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "two.nrrd"}, 1, "found a file");
  for (const char* levels : {"", "5..", "..5", "0..3", "7..21", "6..5", "a..b", "5-6", "5...7"})
    expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--levels", levels}, 2, "--levels");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--engines", "seminodal,best"}, 2, "--engines");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--modes", "slice"}, 2, "--modes");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--fits", "opticom,best"}, 2, "--fits");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--fits", "opticom", "--loss", "l1"}, 2, "--loss");
  expectFailureLeavesAll({"compare", "two.nrrd", "--out", "o", "--loss", "huber"}, 2, "--loss");
  expectFailureLeavesAll({"compare", "two.nrrd"}, 2, "--out");
  expectFailureLeavesAll({"compare", "--out", "o"}, 2, "IN");
  expectFailureLeavesAll({"compare", "field:ball", "--out", "o", "--memory", "1MB"}, 1, "memory limit");
}
