#include "apps/ComparisonOptions.h"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/FitOptions.h"
#include "sparsegrid/hbIndexSet.h"

namespace {

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

std::vector<std::string> engineNames() {
  std::vector<std::string> names;
  for (const auto& engine : hbComparison::allEngines()) names.push_back(engine.name);
  return names;
}

std::vector<std::string> fitNames() {
  std::vector<std::string> names{"interpolation"};
  for (const auto& fit : hbComparison::allFits()) names.push_back(fit.name);
  return names;
}

void addSceneOptions(CLI::App& command, app::SceneOptions& scene) {
  const auto add = [&](const char* group, const char* flag, auto& value, const char* text) {
    return command.add_option(flag, value, text)->group(group);
  };
  add("Picture", "--size", scene.size, "Pixels (default 256x256)")->type_name("WxH");
  add("Picture", "--iso", scene.iso, "Iso-value (default: Otsu's threshold of the histogram)");
  scene.matter.addTo(command);
  add("Camera", "--azimuth", scene.azimuth, "Degrees, counter-clockwise seen from above (default 30)");
  add("Camera", "--elevation", scene.elevation, "Degrees above the horizon (default 20)")
      ->check(CLI::Range(-90.0, 90.0));
  add("Camera", "--zoom", scene.zoom, "1 frames the whole volume (default)")->check(CLI::PositiveNumber);
  add("Camera", "--projection", scene.projection, "perspective (default) or orthographic")
      ->check(CLI::IsMember({"perspective", "orthographic"}));
  add("Camera", "--scene", scene.file, "Start from a scene file")->type_name("S.json");
  add("Rendering", "--samples", scene.samples, "Samples over the depth of the volume (default 128)")
      ->check(CLI::Range(1, hbSampling::kMaxSamples));
  add("Rendering", "--sampling", scene.sampling,
      "planewise (default), as opengl always does, or equidistant; lattice has slices of its own")
      ->check(CLI::IsMember({"equidistant", "planewise"}));
}

} // namespace

void app::ComparisonOptions::addTo(CLI::App& subcommand) {
  input.addTo(subcommand);
  subcommand.add_option("--out", out, "The folder of the page; a comparison that was interrupted goes on there")
      ->required()
      ->type_name("DIR");
  subcommand
      .add_option_function<std::string>(
          "--levels", [](const std::string&) {}, "Levels of the sparse grids (default 5..8)")
      ->check([this](const std::string& text) { return parseLevels(text, what); })
      ->type_name("A..B");
  subcommand
      .add_option("--engines", engines,
                  "seminodal,direct,combination,lattice,full,opengl (default: these), opengl-fused, opengl-blend")
      ->delimiter(',')
      ->check(CLI::IsMember(engineNames()))
      ->type_name("E,...");
  subcommand.add_option("--modes", modes, "xray,mip,iso,dvr (default: all)")
      ->delimiter(',')
      ->check(CLI::IsMember({"xray", "mip", "iso", "dvr"}))
      ->type_name("M,...");
  subcommand
      .add_option("--fits", fits,
                  "interpolation,opticom,least-squares: beside the sparse grids that interpolate, which always take "
                  "part, those fitted to all samples (default: interpolation)")
      ->delimiter(',')
      ->check(CLI::IsMember(fitNames()))
      ->type_name("F,...");
  addLoss(subcommand, what.loss,
          "Of the fits: none (default), squared residuals; huber, those of bad samples count less");
  subcommand.add_option("--component", what.scene.component, "Which component, from 0")->check(CLI::Range(0, 65535));
  subcommand.add_option("--repeat", what.repeats, "Frames to time of each case, after one to warm up")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  subcommand
      .add_option("--max-error", what.limits.maxError, "What to recommend for: greatest error (1 % of the range)")
      ->check(CLI::NonNegativeNumber)
      ->group("Recommendations");
  subcommand.add_option("--max-seconds", what.limits.frameSeconds, "... seconds of a frame (0.1)")
      ->check(CLI::PositiveNumber)
      ->group("Recommendations");
  subcommand.add_option("--max-bytes", what.limits.bytes, "... size, as in 100kB (1 % of the volume's)")
      ->transform(CLI::AsSizeValue(false))
      ->group("Recommendations");
  subcommand.add_flag("--no-peers", noPeers, "Leave out zfp and VTK, which take part where they are installed");
  subcommand.add_flag("--hard-cases", hardCases,
                      "Also measure what rounding does to fields and views where it hurts, by every engine");
  subcommand.add_flag("--restart", what.restart, "Begin anew in a folder that holds a comparison");
  addSceneOptions(subcommand, scene);
}

void app::ComparisonOptions::complete(const CommonOptions& common) {
  if (!engines.empty()) what.engines.clear();
  for (const std::string& name : engines) what.engines.push_back(hbComparison::engineFromName(name));
  for (const auto& fit : hbComparison::allFits())
    if (std::find(fits.begin(), fits.end(), fit.name) != fits.end()) what.fits.push_back(fit);
  if (what.loss != hbFitLoss::Kind::none && what.fits.empty())
    throw CLI::ValidationError("--loss", "expected --fits opticom or least-squares beside it");
  if (!modes.empty()) what.modes.clear();
  for (const std::string& name : modes) what.modes.push_back(hb::modeFromName(name));
  what.scene.sampling.samples = 1; // until the scene is known
  what.validate();
  if (noPeers) what.peerFolders.reset();
  what.nonFinite = input.nanValue;
  what.threads = common.threads;
  what.memoryLimit = common.memoryLimit();
  what.command = common.command;
  what.version = HBVOL_VERSION;
  input.rawLayout();
}

hbScene app::ComparisonOptions::sceneFor(const hbGeometry& geometry) const {
  SceneOptions options = scene;
  if (scene.file.empty()) {
    if (scene.size.empty()) options.size = "256x256";
    if (scene.sampling.empty()) options.sampling = "planewise";
  }
  hbScene result = options.scene(geometry);
  if (result.sampling.samples == 0) result.sampling.samples = 128;
  result.component = what.scene.component;
  return result;
}
