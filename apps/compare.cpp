#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/ComparisonOptions.h"
#include "apps/ComparisonText.h"
#include "apps/Program.h"
#include "report/hbComparisonFindings.h"
#include "report/hbComparisonFolder.h"
#include "report/hbComparisonPage.h"
#include "report/hbComparisonPlots.h"
#include "report/hbComparisonRun.h"
#include "report/hbComparisonSource.h"
#include "report/hbComparisonTable.h"
#include "report/hbHardCaseJson.h"
#include "report/hbHardCaseResults.h"
#include "volume/hbError.h"

namespace {

bool hasFailed(const nlohmann::ordered_json& hardCase) {
  const auto& results = hardCase["results"];
  return std::any_of(results.begin(), results.end(), [](const auto& one) { return one["status"] == "failed"; });
}

/// A record a case; of those that were kept, what failed is measured again.
nlohmann::ordered_json hardCases(hbComparisonFolder& folder) {
  const hbHardCaseRun run;
  const auto ways = std::int64_t(hbHardCaseWay::all().size());
  app::progress().begin("hard cases", std::int64_t(hb::hardCases().size()) * ways, "measurements");
  auto cases = nlohmann::ordered_json::array();
  for (const hbHardCase& one : hb::hardCases()) {
    const std::string key = "hard-" + one.name;
    if (auto known = folder.find(key); known && !hasFailed(*known)) {
      cases.push_back(std::move(*known));
      app::progress().advance(ways);
    } else {
      cases.push_back(folder.keep(key, hb::toJson(run.of(one, app::progress()))));
    }
  }
  return {{"cases", std::move(cases)}};
}

nlohmann::ordered_json measure(const hbComparisonSource& source, const app::ComparisonOptions& options,
                               hbComparisonFolder& folder) {
  try {
    nlohmann::ordered_json report = hbComparisonRun(source, options.what, folder).run(app::progress());
    report["hard_cases"] = options.hardCases ? hardCases(folder) : nlohmann::ordered_json();
    return report;
  } catch (const hbCancelled&) {
    throw hbCancelled(fmt::format("interrupted; what was measured is kept in {}, where the same command goes on",
                                  folder.path().string()));
  }
}

void run(app::ComparisonOptions& options, const app::CommonOptions& common) {
  hbComparison& what = options.what;
  const auto open = [&] { return options.input.open(common, app::progress()); };
  const hbComparisonSource source(open, what.scene.component, what.nonFinite, what.memoryLimit, app::progress());
  what.scene = options.sceneFor(source.volume().geometry());
  what.validate();
  hbComparisonFolder folder(options.out, hbComparisonRun::identity(source, what), what.restart);
  nlohmann::ordered_json report = measure(source, options, folder);
  hb::markParetoFronts(report);
  hb::addConvergenceOrders(report);
  hb::addRecommendations(report, what.limits);
  app::progress().begin("drawing plots", 1, "page");
  try {
    hb::makeComparisonPlots(report, folder.path(), app::progress());
  } catch (const hbCancelled&) {
    throw;
  } catch (const hbError& error) {
    app::clearProgress();
    fmt::print(stderr, "hbvol: warning: the page has no plots: {}\n", error.what());
  }
  hb::writeJson(report, folder.path() / "report.json");
  hb::writeComparisonTable(report, folder.path() / "report.csv");
  hb::writeComparisonPage(report, folder.path());
  app::clearProgress();
  app::printComparison(report, options.out);
  common.writeStats(report);
}

app::Work prepare(app::ComparisonOptions& options, const app::CommonOptions& common) {
  options.complete(common);
  return [&] { run(options, common); };
}

} // namespace

void addCompare(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<app::ComparisonOptions>();
  CLI::App* command = program.add_subcommand(
      "compare", "Sets speed against error: sparse grids of several levels by several engines, on one page");
  options->addTo(*command);
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
