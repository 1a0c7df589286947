#include "report/hbHardCase.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "glcombine/hbGlContext.h"
#include "report/hbHardCaseJson.h"
#include "report/hbHardCaseMeasurement.h"
#include "report/hbHardCaseResults.h"
#include "report/hbHardCaseTable.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "volume/hbError.h"

namespace {

using Engine = hbHardCaseWay::Engine;
using Status = hbHardCaseResult::Status;

/// A case and a way, by their places in the lists.
using Choice = std::tuple<std::size_t, std::size_t>;

const hbHardCase& caseOf(const Choice& choice) { return hb::hardCases()[std::get<0>(choice)]; }
hbHardCaseWay wayOf(const Choice& choice) { return hbHardCaseWay::all()[std::get<1>(choice)]; }

const hbHardCase& named(const std::string& name) {
  for (const hbHardCase& one : hb::hardCases())
    if (one.name == name) return one;
  throw hbError("hard case: expected a known one, found '" + name + "'");
}

std::string words(std::string text) {
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

hbHardCaseResult measured(const hbHardCase& one, const hbHardCaseWay& way) {
  const hbHardCase::Problem problem = one.make();
  if (!way.isOpenGl()) return hb::measureHardCase(problem, way, nullptr);
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  return hb::measureHardCase(problem, way, context.get());
}

class hbHardCaseTest : public testing::TestWithParam<Choice> {};

/// A grid with one corner's surplus off by `part` of the largest: some points move by that, others by part of it.
hbSparseGrid disturbed(const hbSparseGrid& grid, double part) {
  const auto surpluses = grid.surpluses(0);
  std::vector<float> changed(surpluses.begin(), surpluses.end());
  double largest = 0.0;
  for (const float s : changed) largest = std::max(largest, double(std::abs(s)));
  changed.front() += float(part * largest);
  return hbSparseGrid::fromSurpluses(grid.frame(), grid.indexSet(), {std::move(changed)});
}

/// Where rounding may do as much as the range of the values: 8 bits in all but slices and the coarsest grid, numbers
/// that shaders take for 0, an offset that is kept, and 16 bits shared by 199 component grids.
bool saysNothing(const std::string& name, const hbHardCaseWay& way) {
  static const std::set<std::string> fewGrids{"two-samples", "slice-x", "slice-z", "level-1"};
  static const std::map<std::string, std::set<std::string>> others{
      {"large-offset-kept",
       {"combination", "opengl-blend-r32f", "opengl-blend-r16f", "opengl-blend-r16", "opengl-fused"}},
      {"subnormal", {"opengl-blend-r32f", "opengl-fused", "opengl"}},
      {"level-12", {"opengl-blend-r16f", "opengl-blend-r16"}}};
  if (way.engine == Engine::blend && way.format == hbGlFormat::r8) return !fewGrids.contains(name);
  const auto found = others.find(name);
  return found != others.end() && found->second.contains(way.label());
}

double worstShare(const std::vector<hbHardCaseError>& errors) {
  double worst = 0.0;
  for (const hbHardCaseError& one : errors) worst = std::max(worst, one.error / one.bound);
  return worst;
}

} // namespace

TEST_P(hbHardCaseTest, IsWithinItsBound) {
  const hbHardCaseResult result = measured(caseOf(GetParam()), wayOf(GetParam()));
  EXPECT_EQ(result.status, Status::done) << result.note;
  EXPECT_FALSE(result.exceedsBound()) << "error " << result.error << ", bound " << result.bound;
  EXPECT_EQ(result.saysNothing, saysNothing(caseOf(GetParam()).name, wayOf(GetParam()))) << "bound " << result.bound;
  EXPECT_GT(result.bound, 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, hbHardCaseTest,
                         testing::Combine(testing::Range(std::size_t{0}, hb::hardCases().size()),
                                          testing::Range(std::size_t{0}, hbHardCaseWay::all().size())),
                         [](const auto& choice) {
                           return words(caseOf(choice.param).name + "_by_" + wayOf(choice.param).label());
                         });

// A hundredth of the largest surplus is more than all but 8 bits may lose.
TEST(hbHardCases, AWrongValueExceedsTheBound) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  for (const char* name : {"marschner-lobb-below", "odd-sizes-aligned", "view-along-axis", "iso-tangent"}) {
    const hbHardCase::Problem problem = named(name).make();
    const hbSparseGrid wrong = disturbed(problem.grid, 0.01);
    const auto measurement = hbHardCaseMeasurement::of(problem, &wrong);
    for (const hbHardCaseWay& way : hbHardCaseWay::all()) {
      if (way.engine == Engine::stored || (way.engine == Engine::blend && way.format != hbGlFormat::r32f)) continue;
      EXPECT_GT(worstShare(measurement->errors(way, context.get())), 1.0) << name << " by " << way.label();
    }
  }
}

// In 8 bits, nodal values are the sum of more steps than there are; with half of the texels' range it shows.
TEST(hbHardCases, AWrongValueExceedsTheBoundOfEveryFormat) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbHardCase::Problem problem = named("level-1").make();
  const hbSparseGrid wrong = disturbed(problem.grid, 0.5);
  const auto measurement = hbHardCaseMeasurement::of(problem, &wrong);
  for (const hbGlFormat format : {hbGlFormat::r32f, hbGlFormat::r16f, hbGlFormat::r16, hbGlFormat::r8})
    EXPECT_GT(worstShare(measurement->errors({Engine::blend, format}, context.get())), 1.0) << hb::glFormatName(format);
}

// The coefficients' magnitudes; values lie within 1 of each other, and all component grids have about 1.
TEST(hbHardCases, TheAlternatingSumIsManyTimesTheRangeAtLevelEleven) {
  const hbHardCase::Problem problem = named("checkerboard").make();
  EXPECT_EQ(hb::amplification(problem.grid.indexSet()), 221.0);
  const auto measurement = hbHardCaseMeasurement::of(problem);
  EXPECT_LE(measurement->range(), 1.1);
  EXPECT_GT(measurement->range(), 0.9);
  EXPECT_GT(measurement->amplification().combination, 200.0);
}

// Centred, as the reader does it, a small signal on a large offset is as good as without; else a sixteenth is lost.
TEST(hbHardCases, ALargeOffsetIsTakenAway) {
  for (const Engine engine : {Engine::direct, Engine::seminodal, Engine::combination, Engine::lattice}) {
    EXPECT_TRUE(measured(named("large-offset"), {engine}).stable) << int(engine);
    EXPECT_FALSE(measured(named("large-offset-kept"), {engine}).stable) << int(engine);
  }
}

TEST(hbHardCases, NoNumberAndNoBoundAreNotWithinIt) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto of = [](const hbHardCaseError& one) {
    return hbHardCaseResult::of({Engine::direct}, {{0.0, 0.5}, one, {0.1, 0.5}}, 1.0);
  };
  for (const hbHardCaseError& one : {hbHardCaseError{kNaN, 0.5},
                                     {0.1, kNaN},
                                     {0.1, kInfinity},
                                     {kInfinity, kInfinity},
                                     {kInfinity, 0.5},
                                     {0.1, 0.0},
                                     {0.6, 0.5}}) {
    EXPECT_TRUE(of(one).exceedsBound()) << one.error << " of " << one.bound;
    EXPECT_FALSE(of(one).isWithinBound()) << one.error << " of " << one.bound;
  }
  EXPECT_TRUE(of({0.5, 0.5}).isWithinBound());
  EXPECT_TRUE(of({0.0, 0.0}).isWithinBound());
}

TEST(hbHardCases, ABoundOfTheRangeSaysNothing) {
  const hbHardCaseResult result = hbHardCaseResult::of({Engine::direct}, {{0.5, 2.0}}, 2.0);
  EXPECT_TRUE(result.saysNothing);
  EXPECT_FALSE(result.isWithinBound());
  EXPECT_FALSE(result.exceedsBound());
}

TEST(hbHardCases, OpenGlWithoutAContextIsRefused) {
  const hbHardCaseResult result = hb::measureHardCase(named("level-1").make(), {Engine::fused}, nullptr);
  EXPECT_EQ(result.status, Status::refused);
  EXPECT_FALSE(result.note.empty());
  EXPECT_FALSE(result.isWithinBound());
}

namespace {

class Cancelling final : public hbProgress {
protected:
  void show(std::int64_t done, std::int64_t) override {
    if (done >= 3) cancel();
  }
};

std::vector<hbHardCaseResults> twoResults() {
  hbHardCaseResults one;
  one.name = "spikes";
  one.why = "because";
  one.coefficients = 113.0;
  one.range = 2.0;
  one.hierarchicalTerms = 3.0;
  one.combinationTerms = 55.0;
  one.results = {{{Engine::stored}, Status::done, 0.0, 1e-7, 0.0, true, false, ""},
                 {{Engine::direct}, Status::done, 2e-8, 4e-6, 0.5, true, false, ""},
                 {{Engine::blend, hbGlFormat::r8}, Status::done, 1.0, 4.0, 0.25, false, true, ""},
                 {{Engine::fused}, Status::refused, 0.0, 0.0, 0.0, false, false, "too small"}};
  return {one};
}

} // namespace

TEST(hbHardCases, CanBeCancelled) {
  Cancelling progress;
  EXPECT_THROW(hbHardCaseRun().of(named("level-1"), progress), hbCancelled);
}

TEST(hbHardCases, OneThatCannotBeMadeIsAResult) {
  const hbHardCase broken{"broken", "it is", []() -> hbHardCase::Problem { throw hbError("no grid"); }};
  const hbHardCaseResults results = hbHardCaseRun().of(broken);
  EXPECT_EQ(results.name, "broken");
  ASSERT_EQ(results.results.size(), hbHardCaseWay::all().size());
  for (const hbHardCaseResult& one : results.results) {
    EXPECT_EQ(one.status, Status::failed);
    EXPECT_EQ(one.note, "no grid");
  }
  EXPECT_EQ(results.mostStable(), nullptr);
}

TEST(hbHardCases, AsJson) {
  const nlohmann::ordered_json one = hb::toJson(twoResults().front());
  EXPECT_EQ(one["name"], "spikes");
  EXPECT_EQ(one["amplification"], 113.0);
  EXPECT_EQ(one["most_stable"], "direct");
  ASSERT_EQ(one["results"].size(), 4U);
  EXPECT_EQ(one["results"][1]["error"], 2e-8);
  EXPECT_EQ(one["results"][1]["within_bound"], true);
  EXPECT_EQ(one["results"][1]["error_of_range"], 1e-8);
  EXPECT_EQ(one["results"][1]["says_nothing"], false);
  EXPECT_EQ(one["results"][2]["format"], "r8");
  EXPECT_EQ(one["results"][2]["within_bound"], false);
  EXPECT_EQ(one["results"][2]["exceeds_bound"], false);
  EXPECT_EQ(one["results"][2]["says_nothing"], true);
  EXPECT_EQ(one["results"][2]["engine"], "opengl-blend");
  EXPECT_EQ(one["results"][3]["status"], "refused");
  EXPECT_TRUE(one["results"][3]["error"].is_null());
  EXPECT_EQ(one["results"][3]["note"], "too small");
}

TEST(hbHardCases, AsATable) {
  const std::string table = hb::hardCaseTable(twoResults());
  EXPECT_NE(
      table.find("| spikes | 3, 55 | **0e+00 / 5e-08** | **1e-08 / 2e-06** | 5e-01 / no statement | - | direct |\n"),
      std::string::npos)
      << table;
}
