#include "report/hbComparisonFindings.h"

#include <cmath>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace {

using Json = hb::ReportJson;

Json choice(const std::string& key, const std::string& kind, Json level, double bytes, double max, double rmse) {
  return {{"key", key},
          {"kind", kind},
          {"label", key},
          {"level", std::move(level)},
          {"status", "done"},
          {"size", nullptr},
          {"bytes", bytes},
          {"bits_per_sample", bytes / 100.0},
          {"values", {{"max", max}, {"rmse", rmse}, {"psnr", 1.0}}},
          {"true_values", nullptr}};
}

Json drawn(const std::string& choice, const std::string& engine, double bytes, double seconds, double rmse) {
  return {{"key", choice + "-" + engine + "-mip"},
          {"choice", choice},
          {"engine", engine},
          {"mode", "mip"},
          {"status", "done"},
          {"compressed_bytes", bytes},
          {"seconds_frame", {{"median", seconds}}},
          {"picture", {{"max", rmse}, {"rmse", rmse}, {"psnr", rmse == 0.0 ? Json() : Json(30.0)}}}};
}

/// The volume and two sparse grids; the finer one drawn by two engines, one of which is slower.
Json report() {
  Json failed = drawn("s6", "opengl", 200.0, 0.0, 0.0);
  failed["status"] = "failed";
  failed["picture"] = failed["seconds_frame"] = nullptr;
  return {{"settings", {{"modes", {"mip"}}}},
          {"input", {{"range", {0.0, 10.0}}, {"bytes_uncompressed", 20000}}},
          {"choices",
           {choice("original", "original", nullptr, 20000.0, 0.0, 0.0), choice("s5", "sparse", 5, 100.0, 0.5, 0.2),
            choice("s6", "sparse", 6, 200.0, 0.09, 0.05)}},
          {"cases",
           {drawn("original", "full", 20000.0, 0.05, 0.0), drawn("s5", "lattice", 100.0, 0.01, 0.4),
            drawn("s6", "lattice", 200.0, 0.02, 0.1), drawn("s6", "direct", 200.0, 0.3, 0.1), failed}}};
}

} // namespace

TEST(hbComparisonFindings, MarksParetoFronts) {
  Json r = report();
  Json other = drawn("original", "vtk-cpu", 20000.0, 1e-9, 1e-9); // would beat all, if its errors were the same figures
  other["image_only"] = true;
  r["cases"].push_back(other);
  hb::markParetoFronts(r);
  const auto marks = [&](const char* name) {
    std::vector<bool> list;
    for (const Json& one : r["cases"]) list.push_back(one[name]);
    return list;
  };
  EXPECT_EQ(marks("pareto_time"), (std::vector<bool>{true, true, true, false, false, false}));
  EXPECT_EQ(marks("pareto_bytes"), (std::vector<bool>{true, true, true, true, false, false}));
}

TEST(hbComparisonFindings, OrdersOfConvergenceAreSlopes) {
  Json r = report();
  r["choices"][1]["true_values"] = {{"rmse", 8.0}};
  r["choices"][2]["true_values"] = {{"rmse", 2.0}};
  for (const std::int64_t nodes : {11, 31}) {
    Json coarse = choice("c", "coarse", 5, 100.0, 0.5, nodes == 11 ? 0.9 : 0.1);
    coarse["size"] = {nodes, 5, 3};
    r["choices"].push_back(coarse);
  }
  hb::addConvergenceOrders(r);
  EXPECT_TRUE(r["choices"][0]["order"].is_null());
  EXPECT_TRUE(r["choices"][1]["order"].is_null());
  EXPECT_DOUBLE_EQ(r["choices"][2]["order"].get<double>(), 2.0); // a quarter of the error at half the width
  EXPECT_DOUBLE_EQ(r["choices"][2]["true_order"].get<double>(), 2.0);
  EXPECT_TRUE(r["choices"][3]["order"].is_null());
  EXPECT_DOUBLE_EQ(r["choices"][4]["order"].get<double>(), 2.0); // a ninth at a third
  EXPECT_TRUE(r["choices"][4]["true_order"].is_null());
}

TEST(hbComparisonFindings, FailedAndExactChoicesHaveNoOrder) {
  Json r = report();
  r["choices"][1]["values"]["rmse"] = 0.0;
  hb::addConvergenceOrders(r);
  EXPECT_TRUE(r["choices"][2]["order"].is_null());
  Json failed = report();
  failed["choices"][1]["status"] = "failed";
  failed["choices"][1].erase("values");
  hb::addConvergenceOrders(failed);
  EXPECT_TRUE(failed["choices"][2]["order"].is_null());
}

TEST(hbComparisonFindings, RecommendsByErrorTimeAndBytes) {
  Json r = report();
  hb::addRecommendations(r, {});
  const Json& list = r["recommendations"];
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[0]["question"], "max error <= 0.1"); // 1 % of the range
  EXPECT_EQ(list[0]["choice"], "s6");                 // s5 is off by more, the volume has more bytes
  EXPECT_EQ(list[0]["answer"],
            "s6: 200 bytes, 2 bits a sample, max error 0.09, RMSE 0.05; a frame: mip 20 ms by lattice");
  EXPECT_EQ(list[1]["question"], "a frame of mip <= 100 ms");
  EXPECT_EQ(list[1]["case"], "original-full-mip");
  EXPECT_EQ(list[1]["answer"],
            "original by full: 50 ms, 19.53 kB, picture exact; compressed, s6 by lattice: 20 ms, 200 bytes, "
            "picture 30 dB");
  EXPECT_EQ(list[2]["question"], "at most 200 bytes"); // 1 % of the volume
  EXPECT_EQ(list[2]["choice"], "s6");
}

/// The report with a fit at both levels, the coarser of which gains more.
Json fittedReport() {
  Json r = report();
  r["settings"]["fits"] = {"least-squares"};
  for (const auto& [level, bytes, rmse] : {std::tuple(5, 150.0, 0.05), std::tuple(6, 300.0, 0.02)}) {
    Json fit = choice(fmt::format("f{}", level), "least-squares", level, bytes, 1.0, rmse);
    fit["fit"] = {{"improved", true}};
    fit["seconds_build"] = 4.0;
    r["choices"].push_back(fit);
  }
  for (const std::size_t i : {1, 2}) r["choices"][i]["seconds_build"] = 0.5;
  return r;
}

TEST(hbComparisonFindings, SaysWhatFitsAreGoodFor) {
  Json r = fittedReport();
  hb::addRecommendations(r, {});
  ASSERT_EQ(r["recommendations"].size(), 4U);
  EXPECT_EQ(r["recommendations"][3]["question"], "a fit by least-squares");
  EXPECT_EQ(r["recommendations"][3]["choice"], "f5"); // a quarter of the RMSE; the finer one has 0.4 of it
  EXPECT_TRUE(r["recommendations"][3]["limit"].is_null());
  EXPECT_EQ(r["recommendations"][3]["answer"],
            "f5: RMSE 0.05 instead of 0.2 by interpolation, 150 bytes instead of 100 bytes, made in 4 s instead of "
            "0.5 s; in no more bytes interpolation has RMSE 0.2, at level 5");
  r["choices"][3]["bytes"] = 250.0; // now the finer interpolating grid takes no more
  hb::addRecommendations(r, {});
  const std::string answer = r["recommendations"][3]["answer"];
  EXPECT_NE(answer.find("interpolation has RMSE 0.05, at level 6"), std::string::npos) << answer;
  r["choices"][3]["bytes"] = 50.0; // fewer than any
  hb::addRecommendations(r, {});
  EXPECT_TRUE(r["recommendations"][3]["answer"].get<std::string>().ends_with("instead of 0.5 s"));
}

TEST(hbComparisonFindings, FitsThatGainNothingAreNotRecommended) {
  Json r = fittedReport();
  r["choices"][3]["fit"]["improved"] = false;
  hb::addRecommendations(r, {});
  EXPECT_EQ(r["recommendations"][3]["choice"], "f6");
  r["choices"][4]["status"] = "failed";
  hb::addRecommendations(r, {});
  EXPECT_TRUE(r["recommendations"][3]["choice"].is_null());
  EXPECT_EQ(r["recommendations"][3]["answer"], "none of these: no better than interpolation");
}

TEST(hbComparisonFindings, FitsHaveOrdersOfTheirOwn) {
  Json r = fittedReport();
  r["choices"][4]["values"]["rmse"] = 0.0125;
  hb::addConvergenceOrders(r);
  EXPECT_DOUBLE_EQ(r["choices"][2]["order"].get<double>(), 2.0);
  EXPECT_TRUE(r["choices"][3]["order"].is_null());
  EXPECT_DOUBLE_EQ(r["choices"][4]["order"].get<double>(), 2.0); // a quarter at half the width
}

TEST(hbComparisonFindings, ErrorsThatOverflowAreInfinite) {
  Json r = report();
  r["choices"][1]["values"] = {{"max", 1e170}, {"rmse", nullptr}, {"psnr", nullptr}};
  r["cases"][1]["picture"] = {{"max", 1e30}, {"rmse", 1e30}, {"psnr", nullptr}};
  hb::addRecommendations(r, {1e171, 0.015, std::nullopt});
  EXPECT_EQ(r["recommendations"][0]["choice"], "s5");
  EXPECT_NE(r["recommendations"][0]["answer"].get<std::string>().find("RMSE inf"), std::string::npos);
  // Without a PSNR and without an error are different things.
  EXPECT_NE(r["recommendations"][1]["answer"].get<std::string>().find("picture RMSE 1e+30"), std::string::npos);
  r["input"]["range"] = {nullptr, nullptr};
  hb::addRecommendations(r, {});
  EXPECT_EQ(r["recommendations"][0]["limit"], 0.0);
}

TEST(hbComparisonFindings, RecommendsByWhatIsAskedFor) {
  Json r = report();
  hb::addRecommendations(r, {0.6, 0.015, 150.0});
  EXPECT_EQ(r["recommendations"][0]["choice"], "s5");
  EXPECT_EQ(r["recommendations"][1]["case"], "s5-lattice-mip");
  EXPECT_EQ(r["recommendations"][2]["choice"], "s5");
  hb::addRecommendations(r, {std::nullopt, 0.001, 1.0});
  EXPECT_TRUE(r["recommendations"][1]["case"].is_null());
  EXPECT_EQ(r["recommendations"][1]["answer"], "none of these");
  EXPECT_TRUE(r["recommendations"][2]["choice"].is_null());
}
