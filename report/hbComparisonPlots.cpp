#include "report/hbComparisonPlots.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/hbPlot.h"
#include "report/hbReportPlace.h"
#include "volume/hbTextFile.h"

namespace {

using Json = nlohmann::ordered_json;
using Line = hbPlot::Line;

constexpr double kMilliseconds = 1e3; // a second
constexpr double kKilobyte = 1024.0;

// ---- looks: the colours that M. Okabe and K. Ito chose so that all people can tell them apart ----

const std::map<std::string, std::string> kKindColors{{"original", "#000000"}, {"sparse", "#0072b2"},
                                                     {"coarse", "#e69f00"},   {"zfp", "#cc79a7"},
                                                     {"opticom", "#009e73"},  {"least-squares", "#d55e00"}};
const std::map<std::string, std::string> kEngineColors{
    {"seminodal", "#0072b2"}, {"direct", "#d55e00"}, {"combination", "#009e73"}, {"lattice", "#56b4e9"}};
const std::map<std::string, std::string> kKindNames{
    {"original", "original"}, {"sparse", "sparse"}, {"coarse", "coarser grid"}, {"least-squares", "least squares"}};
const std::map<std::string, int> kKindPoints{{"original", 13}, {"sparse", 7},   {"coarse", 5},
                                             {"zfp", 9},       {"opticom", 11}, {"least-squares", 15}};
constexpr auto kOtherColor = "#777777";

std::string found(const std::map<std::string, std::string>& map, const std::string& key, const std::string& otherwise) {
  const auto at = map.find(key);
  return at == map.end() ? otherwise : at->second;
}

/// Looks that are the same in every plot: sparse grids that interpolate have a colour an engine, the others one a kind;
/// OpenGL and VTK have open points, their variants other dashes.
hbPlot::Series seriesOf(const std::string& kind, const std::string& engine) {
  hbPlot::Series series;
  series.title = found(kKindNames, kind, kind) + ", " + engine;
  series.color = kind == "sparse" ? found(kEngineColors, engine, kOtherColor) : found(kKindColors, kind, kOtherColor);
  const bool foreign = engine.starts_with("opengl") || engine.starts_with("vtk");
  const auto point = kKindPoints.find(kind);
  series.point = (point == kKindPoints.end() ? 11 : point->second) - (foreign ? 1 : 0); // open ones come before
  if (engine == "opengl-fused" || engine == "vtk-gpu") series.line = Line::dashed;
  if (engine == "opengl-blend") series.line = Line::dotted;
  return series;
}

hbPlot::Series seriesOf(const std::string& kind) {
  hbPlot::Series series;
  series.title = found(kKindNames, kind, kind);
  series.color = found(kKindColors, kind, kOtherColor);
  const auto point = kKindPoints.find(kind);
  series.point = point == kKindPoints.end() ? 11 : point->second;
  return series;
}

// ---- points ----

struct Case {
  std::string kind, engine;
  std::optional<double> level, milliseconds, kilobytes;
  std::optional<double> error; ///< Of the picture, in its values; none where it was compared as an image of bytes.
  bool paretoTime = false, paretoBytes = false;
};

std::optional<double> scaled(const hbReportPlace& place, double factor) {
  const auto number = place.number();
  return number ? std::optional(*number * factor) : std::nullopt;
}

std::vector<Case> casesOf(const hbReportPlace& report, const std::string& mode) {
  std::map<std::string, hbReportPlace> choices;
  for (std::size_t i = 0; i < report["choices"].size(); ++i)
    choices.emplace(report["choices"][i]["key"].text(), report["choices"][i]);
  std::vector<Case> cases;
  for (std::size_t i = 0; i < report["cases"].size(); ++i) {
    const auto one = report["cases"][i];
    const auto choice = choices.find(one["choice"].text());
    if (one["mode"].text() != mode || one["status"].text() != "done" || choice == choices.end()) continue;
    cases.push_back({choice->second["kind"].text(), one["engine"].text(), choice->second["level"].number(),
                     scaled(one["seconds_frame"]["median"], kMilliseconds),
                     scaled(one["compressed_bytes"], 1.0 / kKilobyte),
                     one["image_only"].truth() ? std::nullopt : one["picture"]["rmse"].number(),
                     one["pareto_time"].truth(), one["pareto_bytes"].truth()});
  }
  return cases;
}

using Value = std::optional<double> Case::*;

/// A point of a case that has both; x must be positive, as it lies on a logarithmic axis without a zero.
std::optional<std::pair<double, double>> pointOf(const Case& one, Value x, Value y) {
  if (!(one.*x) || !(one.*y) || *(one.*x) <= 0.0) return std::nullopt;
  return std::pair(*(one.*x), *(one.*y));
}

/// The series of a name, in the order of their first points.
hbPlot::Series& seriesIn(hbPlot& plot, const hbPlot::Series& like) {
  const auto at =
      std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& one) { return one.title == like.title; });
  return at != plot.series.end() ? *at : plot.series.emplace_back(like);
}

void addFront(hbPlot& plot, const std::vector<Case>& cases, Value x, bool Case::*marked) {
  hbPlot::Series front{"Pareto front", "#c8c8c8", Line::solid, 0, 6.0, {}};
  for (const Case& one : cases)
    if (const auto point = pointOf(one, x, &Case::error); point && one.*marked) front.points.push_back(*point);
  std::sort(front.points.begin(), front.points.end());
  plot.series.insert(plot.series.begin(), front); // below the points
}

// ---- plots ----

hbPlot errorOverTime(const std::vector<Case>& cases, const std::string& mode) {
  hbPlot plot{mode + ": error of the picture over time", "ms a frame (median)", "RMSE of the picture", true, {}};
  for (const Case& one : cases)
    if (const auto point = pointOf(one, &Case::milliseconds, &Case::error))
      seriesIn(plot, seriesOf(one.kind, one.engine)).points.push_back(*point);
  addFront(plot, cases, &Case::milliseconds, &Case::paretoTime);
  return plot;
}

hbPlot errorOverBytes(const std::vector<Case>& cases, const std::string& mode) {
  hbPlot plot{mode + ": error of the picture over size", "kB kept (compressed)", "RMSE of the picture", true, {}};
  for (const Case& one : cases)
    if (const auto point = pointOf(one, &Case::kilobytes, &Case::error)) {
      auto& series = seriesIn(plot, seriesOf(one.kind));
      series.line = Line::none; // engines lie at nearly one place
      series.points.push_back(*point);
    }
  addFront(plot, cases, &Case::kilobytes, &Case::paretoBytes);
  return plot;
}

std::set<double> levelsOf(const std::vector<Case>& cases) {
  std::set<double> levels;
  for (const Case& one : cases)
    if (one.level) levels.insert(*one.level);
  return levels;
}

/// What has no level takes its time at any: a line from the first to the last.
hbPlot timeOverLevel(const std::vector<Case>& cases, const std::string& mode) {
  hbPlot plot{mode + ": time over level", "level", "ms a frame (median)", false, {}};
  const auto levels = levelsOf(cases);
  if (levels.size() < 2) return plot;
  for (const Case& one : cases) {
    if (!one.milliseconds) continue;
    auto& series = seriesIn(plot, seriesOf(one.kind, one.engine));
    if (one.level) {
      series.points.emplace_back(*one.level, *one.milliseconds);
    } else {
      series.points = {{*levels.begin(), *one.milliseconds}, {*levels.rbegin(), *one.milliseconds}};
      series.line = Line::dashed;
    }
  }
  return plot;
}

/// A line from the first point of the first series that falls by 2^-order a level.
void addSlope(hbPlot& plot, const std::vector<std::pair<double, double>>& along, int order, Line line) {
  hbPlot::Series slope{fmt::format("order {}", order), "#999999", line, 0, 1.0, {}};
  for (const auto& [level, error] : along)
    slope.points.emplace_back(level, along[0].second * std::exp2(-order * (level - along[0].first)));
  plot.series.push_back(slope);
}

/// `errors` is "values" or "true_values".
hbPlot convergence(const hbReportPlace& report, const char* errors, const std::string& against) {
  hbPlot plot{"RMSE of the values against " + against,
              "level (of others: of the sparse grid of as many bytes)",
              "RMSE of the values",
              false,
              {}};
  for (std::size_t i = 0; i < report["choices"].size(); ++i) {
    const auto choice = report["choices"][i];
    const auto level = choice["level"].number(), rmse = choice[errors]["rmse"].number();
    if (level && rmse) seriesIn(plot, seriesOf(choice["kind"].text())).points.emplace_back(*level, *rmse);
  }
  const bool several =
      std::any_of(plot.series.begin(), plot.series.end(), [](const auto& s) { return s.points.size() > 1; });
  if (!several) return {};
  const auto along = plot.series[0].points;
  addSlope(plot, along, 1, Line::dashed);
  addSlope(plot, along, 2, Line::dotted);
  return plot;
}

/// Only where there are fits, which take other bytes than interpolation at the same level.
hbPlot valuesOverBytes(const hbReportPlace& report) {
  hbPlot plot{
      "RMSE of the values against the samples, over size", "kB kept (compressed)", "RMSE of the values", true, {}};
  if (report["settings"]["fits"].null()) return plot;
  for (std::size_t i = 0; i < report["choices"].size(); ++i) {
    const auto choice = report["choices"][i];
    const auto kilobytes = scaled(choice["bytes"], 1.0 / kKilobyte), rmse = choice["values"]["rmse"].number();
    if (choice["level"].number() && kilobytes && rmse)
      seriesIn(plot, seriesOf(choice["kind"].text())).points.emplace_back(*kilobytes, *rmse);
  }
  return plot;
}

class PlotFolder {
public:
  PlotFolder(const std::filesystem::path& folder, hbProgress& progress)
      : folder_(folder), progress_(progress), gnuplot_(hbPlot::findGnuplot()) {
    std::filesystem::create_directories(folder_ / "plots");
  }

  /// Draws the plot, if there is something to be seen, and notes its place under `kind` and `of`.
  void add(const hbPlot& plot, const std::string& kind, const std::string& of) {
    if (plot.empty()) return;
    std::string name = fmt::format("plots/{}-{}.svg", kind, of);
    std::replace(name.begin(), name.end(), '_', '-');
    hb::saveText(plot.svg(gnuplot_, progress_), folder_ / name);
    plots[kind][of] = name;
  }

  Json plots = Json::object();

private:
  std::filesystem::path folder_;
  hbProgress& progress_;
  hbExternalProgram gnuplot_;
};

} // namespace

void hb::makeComparisonPlots(Json& report, const std::filesystem::path& folder, hbProgress& progress) {
  const hbReportPlace place(report);
  PlotFolder plots(folder, progress);
  const auto modes = place["settings"]["modes"];
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const std::string mode = modes[i].text();
    const auto cases = casesOf(place, mode);
    plots.add(errorOverTime(cases, mode), "error_time", mode);
    plots.add(errorOverBytes(cases, mode), "error_bytes", mode);
    plots.add(timeOverLevel(cases, mode), "time_level", mode);
  }
  plots.add(convergence(place, "values", "the samples"), "convergence", "values");
  plots.add(convergence(place, "true_values", "the analytic field"), "convergence", "true_values");
  plots.add(valuesOverBytes(place), "convergence", "bytes");
  report["plots"] = plots.plots;
}
