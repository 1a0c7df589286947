#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/Program.h"
#include "apps/SceneOptions.h"
#include "report/hbComparison.h"
#include "report/hbComparisonFindings.h"
#include "report/hbComparisonFolder.h"
#include "report/hbComparisonPage.h"
#include "report/hbComparisonPlots.h"
#include "report/hbComparisonRun.h"
#include "report/hbComparisonSource.h"
#include "report/hbComparisonTable.h"
#include "sparsegrid/hbIndexSet.h"
#include "volume/hbError.h"

namespace {

struct Options {
  app::InputOptions input;
  app::SceneOptions scene;
  hbComparison what;
  std::string out;
  std::vector<std::string> engines, modes;
};

/// "A..B", or one level, into the two levels; what is wrong otherwise.
std::string parseLevels(const std::string& text, hbComparison& what) {
  const std::size_t dots = text.find("..");
  const std::string first = text.substr(0, dots), last = dots == std::string::npos ? first : text.substr(dots + 2);
  const CLI::Range levels(1, hbIndexSet::kMaxLevel);
  for (const std::string& part : {first, last}) {
    std::string number = part;
    if (!levels(number).empty() || part.find_first_not_of("0123456789") != std::string::npos)
      return fmt::format("expected A..B or A, levels from 1 to {}, found '{}'", hbIndexSet::kMaxLevel, text);
  }
  what.firstLevel = std::stoi(first);
  what.lastLevel = std::stoi(last);
  return what.firstLevel <= what.lastLevel ? "" : fmt::format("expected A..B with A <= B, found '{}'", text);
}

void print(const nlohmann::ordered_json& report, const std::string& out) {
  fmt::print("{:<28} {:>10} {:>12} {:>10} {:>10} {:>10}\n", "choice", "kB", "bits/sample", "max error", "RMSE", "PSNR");
  for (const auto& choice : report["choices"]) {
    if (choice["status"] != "done") {
      fmt::print("{:<28} failed: {}\n", choice["label"].get<std::string>(), choice["error"].get<std::string>());
      continue;
    }
    const auto& values = choice["values"];
    fmt::print("{:<28} {:>10.1f} {:>12.4f} {:>10.4g} {:>10.4g} {:>10}\n", choice["label"].get<std::string>(),
               choice["bytes"].get<double>() / 1024.0, choice["bits_per_sample"].get<double>(),
               values["max"].get<double>(), values["rmse"].get<double>(),
               values["psnr"].is_null() ? "equal" : fmt::format("{:.2f} dB", values["psnr"].get<double>()));
  }
  fmt::print("\n");
  for (const auto& one : report["recommendations"])
    fmt::print("for {}: {}\n", one["question"].get<std::string>(), one["answer"].get<std::string>());
  const auto failed = std::count_if(report["cases"].begin(), report["cases"].end(),
                                    [](const auto& one) { return one["status"] != "done"; });
  if (failed > 0) fmt::print("\n{} of {} cases failed; the page says why\n", failed, report["cases"].size());
  fmt::print("\n{}\n", (std::filesystem::path(out) / "index.html").string());
}

nlohmann::ordered_json measure(const hbComparisonSource& source, const hbComparison& what, hbComparisonFolder& folder) {
  try {
    return hbComparisonRun(source, what, folder).run(app::progress());
  } catch (const hbCancelled&) {
    throw hbCancelled(fmt::format("interrupted; what was measured is kept in {}, where the same command goes on",
                                  folder.path().string()));
  }
}

void run(Options& options, const app::CommonOptions& common) {
  hbComparison& what = options.what;
  const auto open = [&] { return options.input.open(common, app::progress()); };
  const hbComparisonSource source(open, what.scene.component, what.nonFinite, what.memoryLimit, app::progress());
  const int component = what.scene.component;
  what.scene = options.scene.scene(source.volume().geometry());
  what.scene.component = component;
  what.validate();
  hbComparisonFolder folder(options.out, hbComparisonRun::identity(source, what), what.restart);
  nlohmann::ordered_json report = measure(source, what, folder);
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
  print(report, options.out);
  common.writeStats(report);
}

app::Work prepare(Options& options, const app::CommonOptions& common) {
  hbComparison& what = options.what;
  if (!options.engines.empty()) what.engines.clear();
  for (const std::string& name : options.engines) what.engines.push_back(hbComparison::engineFromName(name));
  if (!options.modes.empty()) what.modes.clear();
  for (const std::string& name : options.modes) what.modes.push_back(hb::modeFromName(name));
  what.scene.sampling.samples = options.scene.samples;
  what.validate();
  what.nonFinite = options.input.nanValue;
  what.threads = common.threads;
  what.memoryLimit = common.memoryLimit();
  what.command = common.command;
  what.version = HBVOL_VERSION;
  options.input.rawLayout();
  return [&] { run(options, common); };
}

std::vector<std::string> engineNames() {
  std::vector<std::string> names;
  for (const auto& engine : hbComparison::allEngines()) names.push_back(engine.name);
  return names;
}

void addSceneOptions(CLI::App& command, app::SceneOptions& scene) {
  const auto add = [&](const char* group, const char* flag, auto& value, const char* text) {
    return command.add_option(flag, value, text)->group(group);
  };
  scene.size = "256x256";
  scene.samples = 128;
  scene.sampling = "planewise";
  add("Picture", "--size", scene.size, "Pixels")->type_name("WxH")->capture_default_str();
  add("Picture", "--iso", scene.iso, "Iso-value (default: Otsu's threshold of the histogram)");
  scene.matter.addTo(command);
  add("Camera", "--azimuth", scene.azimuth, "Degrees, counter-clockwise seen from above (default 30)");
  add("Camera", "--elevation", scene.elevation, "Degrees above the horizon (default 20)")
      ->check(CLI::Range(-90.0, 90.0));
  add("Camera", "--zoom", scene.zoom, "1 frames the whole volume (default)")->check(CLI::PositiveNumber);
  add("Camera", "--projection", scene.projection, "perspective (default) or orthographic")
      ->check(CLI::IsMember({"perspective", "orthographic"}));
  add("Camera", "--scene", scene.file, "Start from a scene file")->type_name("S.json");
  add("Rendering", "--samples", scene.samples, "Samples over the depth of the volume")
      ->check(CLI::Range(1, hbSampling::kMaxSamples))
      ->capture_default_str();
  add("Rendering", "--sampling", scene.sampling,
      "planewise, as opengl always does, or equidistant; lattice has slices of its own")
      ->check(CLI::IsMember({"equidistant", "planewise"}))
      ->capture_default_str();
}

} // namespace

void addCompare(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  hbComparison& what = options->what;
  CLI::App* command = program.add_subcommand(
      "compare", "Sets speed against error: sparse grids of several levels by several engines, on one page");
  options->input.addTo(*command);
  command->add_option("--out", options->out, "The folder of the page; a comparison that was interrupted goes on there")
      ->required()
      ->type_name("DIR");
  command
      ->add_option_function<std::string>(
          "--levels", [](const std::string&) {}, "Levels of the sparse grids (default 5..8)")
      ->check([options](const std::string& text) { return parseLevels(text, options->what); })
      ->type_name("A..B");
  command
      ->add_option("--engines", options->engines,
                   "seminodal,direct,combination,lattice,full,opengl (default: these), opengl-fused, opengl-blend")
      ->delimiter(',')
      ->check(CLI::IsMember(engineNames()))
      ->type_name("E,...");
  command->add_option("--modes", options->modes, "xray,mip,iso,dvr (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({"xray", "mip", "iso", "dvr"}))
      ->type_name("M,...");
  command->add_option("--component", what.scene.component, "Which component, from 0")->check(CLI::Range(0, 65535));
  command->add_option("--repeat", what.repeats, "Frames to time of each case, after one to warm up")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--max-error", what.limits.maxError, "What to recommend for: greatest error (1 % of the range)")
      ->check(CLI::NonNegativeNumber)
      ->group("Recommendations");
  command->add_option("--max-seconds", what.limits.frameSeconds, "... seconds of a frame (0.1)")
      ->check(CLI::PositiveNumber)
      ->group("Recommendations");
  command->add_option("--max-bytes", what.limits.bytes, "... size, as in 100kB (1 % of the volume's)")
      ->transform(CLI::AsSizeValue(false))
      ->group("Recommendations");
  command->add_flag("!--no-peers", what.withPeers, "Leave out zfp and VTK, which take part where they are installed");
  command->add_flag("--restart", what.restart, "Begin anew in a folder that holds a comparison");
  addSceneOptions(*command, options->scene);
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
