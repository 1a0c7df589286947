#include "report/hbComparisonPlots.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/hbPlot.h"
#include "tests/report/hbTestReport.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

int count(const std::string& text, std::string_view what) {
  int result = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++result;
  return result;
}

/// Points drawn in an SVG of gnuplot's, those of the legend included: each is a use of its shape.
int points(const std::string& svg) { return count(svg, "' transform='translate("); }

hbPlot plotOf(std::vector<std::pair<double, double>> points) {
  hbPlot plot{"title", "x", "y", true, {}};
  plot.series.push_back({"series", "#0072b2", hbPlot::Line::solid, 7, 1.5, std::move(points)});
  return plot;
}

TEST(hbPlot, drawsEveryPointAndText) {
  hbPlot plot = plotOf({{1.0, 2.0}, {3.0, 0.0}, {1e9, 1e-9}});
  plot.title = "it's <a> & \"b\" _c_ \xc3\x84 {d} \\n";
  const std::string svg = plot.svg(hbPlot::findGnuplot());
  EXPECT_EQ(points(svg), 4); // and one in the legend
  EXPECT_NE(svg.find("it's &lt;a> &amp; \"b\" _c_ \xc3\x84 {d} \\n"), std::string::npos);
  EXPECT_EQ(count(svg, ">0</text>"), 1); // the axis of y
}

TEST(hbPlot, sameBytesForTheSamePlot) {
  const hbPlot plot = plotOf({{1.0, 2.0}, {3.0, 0.5}});
  const std::string svg = plot.svg(hbPlot::findGnuplot());
  EXPECT_EQ(plot.svg(hbPlot::findGnuplot()), svg);
}

TEST(hbPlot, withoutPointsItIsEmptyAndRefused) {
  EXPECT_TRUE(plotOf({}).empty());
  EXPECT_FALSE(plotOf({{1.0, 1.0}}).empty());
  EXPECT_THROW(plotOf({}).svg(hbPlot::findGnuplot()), hbError);
}

TEST(hbComparisonPlots, makesAllPlotsOfAReport) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  hb::makeComparisonPlots(report, folder.path());
  for (const char* kind : {"error_time", "error_bytes", "time_level"})
    for (const char* mode : {"xray", "mip"}) {
      const std::string svg = textOf(folder / report["plots"][kind][mode].get<std::string>());
      EXPECT_TRUE(svg.starts_with("<?xml")) << kind << " " << mode;
    }
  EXPECT_EQ(report["plots"]["convergence"].size(), 1U);
  EXPECT_TRUE(textOf(folder / "plots/convergence-values.svg").starts_with("<?xml"));

  // Eight cases of a mode are done; five series and the Pareto front, whose line has no points.
  const std::string svg = textOf(folder / "plots/error-time-mip.svg");
  EXPECT_EQ(points(svg), 8 + 5);
  EXPECT_EQ(count(svg, ">Pareto front</text>"), 1);
  EXPECT_EQ(count(svg, ">0</text>"), 1); // pictures without an error
  EXPECT_EQ(points(textOf(folder / "plots/error-bytes-mip.svg")), 8 + 4);
  // Without a level: at both ends. zfp has one level only.
  EXPECT_EQ(points(textOf(folder / "plots/time-level-mip.svg")), 2 + 2 + 2 + 2 + 1 + 5);
  EXPECT_EQ(points(textOf(folder / "plots/convergence-values.svg")), 2 + 2 + 1 + 3);
}

TEST(hbComparisonPlots, fitsHaveSeriesOfTheirOwn) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  hb::makeComparisonPlots(report, folder.path());
  EXPECT_FALSE(report["plots"]["convergence"].contains("bytes"));
  report = hb::test::fittedReport();
  hb::makeComparisonPlots(report, folder.path());
  const std::string svg = textOf(folder / "plots/error-time-mip.svg");
  EXPECT_EQ(points(svg), 8 + 2 + 6); // two points and a series more than without fits
  EXPECT_EQ(count(svg, ">least squares, seminodal</text>"), 1);
  EXPECT_EQ(points(textOf(folder / "plots/error-bytes-mip.svg")), 8 + 2 + 5);
  EXPECT_EQ(points(textOf(folder / "plots/convergence-values.svg")), 2 + 2 + 1 + 2 + 4);
  // The same choices over their bytes.
  EXPECT_EQ(report["plots"]["convergence"]["bytes"], "plots/convergence-bytes.svg");
  EXPECT_EQ(points(textOf(folder / "plots/convergence-bytes.svg")), 2 + 2 + 1 + 2 + 4);
}

TEST(hbComparisonPlots, errorsOfImagesAreNotDrawn) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  const auto draw = [&] {
    hb::makeComparisonPlots(report, folder.path());
    std::vector<std::string> plots;
    for (const char* name : {"error-time-mip", "error-bytes-mip", "time-level-mip"})
      plots.push_back(textOf(folder / "plots" / (std::string(name) + ".svg")));
    return plots;
  };
  const auto before = draw();
  report["cases"].push_back(hb::test::vtkCase(report, "mip"));
  const auto with = draw();
  EXPECT_EQ(with[0], before[0]);
  EXPECT_EQ(with[1], before[1]);
  EXPECT_EQ(count(with[2], ">original, vtk-gpu</text>"), 1);
}

TEST(hbComparisonPlots, theTrueFieldHasItsOwnConvergence) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  for (Json& choice : report["choices"]) choice["true_values"] = choice["values"];
  hb::makeComparisonPlots(report, folder.path());
  EXPECT_EQ(report["plots"]["convergence"]["true_values"], "plots/convergence-true-values.svg");
}

TEST(hbComparisonPlots, oneLevelHasNoPlotsOverTheLevel) {
  const hbTestFolder folder;
  Json report = hb::test::smallReport();
  hb::makeComparisonPlots(report, folder.path());
  EXPECT_TRUE(report["plots"].contains("error_time"));
  EXPECT_TRUE(report["plots"].contains("error_bytes"));
  EXPECT_FALSE(report["plots"].contains("time_level"));
  EXPECT_FALSE(report["plots"].contains("convergence"));
}

TEST(hbComparisonPlots, aReportWithNothingMeasuredHasNoPlots) {
  const hbTestFolder folder;
  Json report = hb::test::smallReport();
  for (Json& one : report["cases"]) one["status"] = "failed";
  hb::makeComparisonPlots(report, folder.path());
  EXPECT_EQ(report["plots"], Json::object());
}

/// PATH without any program, for as long as it lives.
class NoPrograms {
public:
  NoPrograms() : path_(std::getenv("PATH")) { setenv("PATH", "/no/such/folder", 1); }
  ~NoPrograms() { setenv("PATH", path_.c_str(), 1); }

private:
  std::string path_;
};

TEST(hbComparisonPlots, withoutGnuplotTheReportIsAsBefore) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  const NoPrograms none;
  try {
    hb::makeComparisonPlots(report, folder.path());
    ADD_FAILURE() << "expected an hbError";
  } catch (const hbError& error) {
    EXPECT_EQ(std::string(error.what()).find("gnuplot: expected"), 0U) << error.what();
  }
  EXPECT_EQ(report, hb::test::report());
  EXPECT_EQ(folder.files(), 0);
}

TEST(hbComparisonPlots, cancelled) {
  const hbTestFolder folder;
  Json report = hb::test::report();
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::makeComparisonPlots(report, folder.path(), progress), hbCancelled);
  EXPECT_EQ(report, hb::test::report());
}

} // namespace
