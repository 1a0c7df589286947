#include <array>

#include "tests/apps/hbAppTest.h"

class info : public hbAppTest {};

TEST_F(info, SaysWhatAVolumeHolds) {
  writeVolume<std::uint8_t>("v.nrrd", {4, 3, 2}, 2,
                            [](auto x, auto y, auto z, int c) { return double(x + 10 * y + 100 * z + c); });
  const hbProgramRun found = run({"info", "v.nrrd", "--json"});
  EXPECT_RUNS(found);
  const auto json = found.json();
  EXPECT_EQ(json["representation"], "volume");
  EXPECT_TRUE(json["level"].is_null());
  EXPECT_EQ(json["dims"], (nlohmann::json{4, 3, 2}));
  EXPECT_EQ(json["components"], 2);
  EXPECT_EQ(json["stored_values"], 24);
  EXPECT_TRUE(json.contains("component_grids"));
  EXPECT_TRUE(json.contains("format_version"));
  EXPECT_EQ(json["type"], "uint8");
  EXPECT_EQ(json["statistics"][0]["min"], 0.0);
  EXPECT_EQ(json["statistics"][0]["max"], 123.0);
  EXPECT_EQ(json["statistics"][1]["max"], 124.0);
  EXPECT_EQ(json["statistics"][0]["count"], 24);

  const hbProgramRun text = run({"info", "v.nrrd", "--histogram"});
  EXPECT_RUNS(text);
  EXPECT_NE(text.out.find("4 x 3 x 2"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("component 1: 24 values from 1 to 124"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find('#'), std::string::npos) << text.out;
}

// The sparse-grid paper, Table 1: level, stored values, component grids and padded texels; the values of the
// combination follow from section 3.
TEST_F(info, GivesThePublishedSizes) {
  struct Row {
    int level;
    std::int64_t stored, grids, combination, padded;
  };
  constexpr std::array<Row, 7> kRows{{{5, 1505, 31, 5687, 22016},
                                      {6, 3713, 46, 15188, 63488},
                                      {7, 8961, 64, 38868, 173056},
                                      {8, 21249, 85, 96471, 452608},
                                      {9, 49665, 109, 233949, 1146880},
                                      {10, 114689, 136, 557030, 2834432},
                                      {11, 262145, 166, 1306610, 6864896}}};
  for (const Row& row : kRows) {
    const std::string level = std::to_string(row.level);
    EXPECT_RUNS(run({"compress", "field:hydrogen", "h.hbv", "--level", level, "--measure", "none"}));
    const hbProgramRun compressed = run({"info", "h.hbv", "--json"});
    const hbProgramRun planned = run({"info", "field:hydrogen", "--json", "--level", level});
    EXPECT_RUNS(compressed);
    EXPECT_RUNS(planned);
    for (const auto& json : {compressed.json(), planned.json()}) {
      EXPECT_EQ(json["level"], row.level);
      EXPECT_EQ(json["stored_values"], row.stored);
      EXPECT_EQ(json["component_grids"], row.grids);
      EXPECT_EQ(json["combination_values"], row.combination);
      EXPECT_EQ(json["padded_texels"], row.padded);
    }
    const auto json = compressed.json();
    const std::int64_t side = (std::int64_t{1} << row.level) + 1;
    EXPECT_EQ(json["representation"], "sparse");
    EXPECT_EQ(json["dims"], (nlohmann::json{side, side, side}));
    EXPECT_EQ(json["components"], 1);
    EXPECT_EQ(json["format_version"], "1.0");
  }
}

TEST_F(info, VerifiesSparseFilesOnly) {
  EXPECT_RUNS(run({"compress", "field:ball", "b.hbv", "--level", "3"}));
  const hbProgramRun found = run({"info", "b.hbv", "--json", "--verify"});
  EXPECT_RUNS(found);
  EXPECT_EQ(found.json()["verified"], true);
  EXPECT_EQ(found.json()["errors"][0]["against"], "random points of the analytic field");
  EXPECT_FAILS(run({"info", "field:ball", "--verify"}), 1, "--verify");
  EXPECT_FAILS(run({"info", "b.hbv", "--level", "3"}), 1, "--level");
}

TEST_F(info, PrintsIndexSetsThatCompressReads) {
  EXPECT_RUNS(run({"compress", "field:smooth,size=33x33x1", "a.hbv", "--levels-per-axis", "4,2,1"}));
  const hbProgramRun listed = run({"info", "a.hbv", "--index-set", "--stats", "s.json"});
  EXPECT_RUNS(listed);
  EXPECT_EQ(listed.out, "# lx ly lz\n1 1 0\n2 1 0\n1 2 0\n3 1 0\n4 1 0\n");
  EXPECT_EQ(json("s.json")["subspaces"], 5 + 7); // and those of level 0
  write("set.txt", listed.out);
  EXPECT_RUNS(run({"compress", "field:smooth,size=33x33x1", "b.hbv", "--index-set", "set.txt"}));
  EXPECT_EQ(run({"info", "b.hbv", "--index-set"}).out, listed.out);
  EXPECT_EQ(run({"info", "field:smooth", "--index-set", "--level", "1"}).out, "# lx ly lz\n1 1 1\n");
  EXPECT_FAILS(run({"info", "field:smooth", "--index-set"}), 1, "field:smooth: --index-set expects an .hbv file");
  EXPECT_FAILS(run({"info", "a.hbv", "--index-set", "--level", "1"}), 1, "--level");
  for (const char* other : {"--json", "--verify", "--histogram"})
    EXPECT_FAILS(run({"info", "a.hbv", "--index-set", other}), 2, other);
}

TEST_F(info, RefusesLevelsThereAreNot) {
  for (const char* level : {"0", "-1", "99", "three"})
    expectFailureLeavesAll({"info", "field:ball", "--level", level}, 2, "--level");
}
