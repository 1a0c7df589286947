#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/MetricLimits.h"
#include "apps/Program.h"
#include "report/hbFieldDifference.h"
#include "report/hbPictureDifference.h"
#include "report/hbReportJson.h"
#include "report/hbValueDifference.h"
#include "scene/hbDisplay.h"
#include "scene/hbPictureFile.h"
#include "scene/hbScene.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

struct Options {
  app::InputOptions a;
  std::string b, out;
  bool json = false;
  int component = 0;
  std::int64_t points = std::int64_t{1} << 20;
  app::MetricLimits limits;
};

bool isPicture(const std::string& name) { return app::extension(name) == ".exr" || app::extension(name) == ".png"; }

/// A, B and their difference in one picture, floats through A's window.
void writeSideBySide(const Options& options) {
  const auto a = hb::readPicture(options.a.name), b = hb::readPicture(options.b);
  const auto* floatsA = std::get_if<hbPicture>(&a);
  const auto* floatsB = std::get_if<hbPicture>(&b);
  if (floatsA == nullptr || floatsB == nullptr)
    throw hbError(fmt::format("--out: expected two .exr pictures, found {} and {}", options.a.name, options.b));
  const auto kept = floatsA->metadata.find(hbPicture::kSceneKey);
  const hbScene scene = kept == floatsA->metadata.end() ? hbScene() : hb::sceneFromJson(kept->second, options.a.name);
  const auto window = hb::displayWindow(*floatsA, scene);
  const std::array images{hb::displayImage(*floatsA, scene, window), hb::displayImage(*floatsB, scene, window),
                          hb::absoluteDifferenceImage(*floatsA, *floatsB)};
  hb::writePng(hb::sideBySide(images), options.out);
}

Json pictures(const Options& options) {
  const hbPictureDifference d = hb::pictureFileDifference(options.a.name, options.b);
  return {{"kind", "pictures"},
          {"max", hb::finiteOrNull(d.max)},
          {"rmse", hb::finiteOrNull(d.rmse)},
          {"psnr", hb::numberOrNull(d.psnr)},
          {"ssim", hb::numberOrNull(d.ssim)},
          {"luv_mean", d.luvMean},
          {"luv_max", d.luvMax}};
}

/// A is the reference: a volume is compared at all its samples, anything else at random points of the cube.
Json volumes(const Options& options, const app::CommonOptions& common) {
  const hbInput a = options.a.open(common, app::progress());
  const hbInput b = options.a.open(options.b, common, app::progress());
  if (options.component >= std::min(a.components(), b.components()))
    throw hbError(fmt::format("--component: expected 0 to {}, found {}", std::min(a.components(), b.components()) - 1,
                              options.component));
  const bool sameSize = a.geometry().size == b.geometry().size;
  hbErrorStatistics errors;
  std::string against = "all samples";
  if (a.volume && b.volume && !(sameSize && options.a.nanValue))
    errors = hb::volumeDifference(*a.volume, *b.volume, options.component, app::progress());
  else if (a.volume && sameSize)
    errors = hb::fieldVolumeDifference(*a.volume, *options.a.field(b, b.sparse ? "direct" : "full", common),
                                       options.component, options.a.nanValue, app::progress());
  else {
    errors = hb::fieldDifference(*options.a.field(a, "auto", common), *options.a.field(b, "auto", common),
                                 options.component, options.points, app::progress());
    against = "random points";
  }
  return {{"kind", "volumes"},
          {"max", hb::finiteOrNull(errors.max)},
          {"rmse", hb::finiteOrNull(errors.rmse())},
          {"psnr", hb::numberOrNull(errors.psnr())},
          {"ssim", nullptr},
          {"luv_mean", nullptr},
          {"luv_max", nullptr},
          {"count", errors.count},
          {"against", against}};
}

void print(const Json& result) {
  for (const auto& [key, value] : result.items()) {
    if (value.is_string())
      fmt::print("{:<10}{}\n", key, value.get<std::string>());
    else if (!value.is_null())
      fmt::print("{:<10}{}\n", key, value.dump());
    else if (key == "max" || key == "rmse")
      fmt::print("{:<10}infinite\n", key);
    else if (key == "psnr")
      fmt::print("{:<10}{}\n", key,
                 app::metricValue(result, key) > 0.0 ? "none: nothing differs"
                                                     : "none: an infinite error, or a reference of one value");
  }
}

void run(const Options& options, const app::CommonOptions& common) {
  const Json result = isPicture(options.a.name) || isPicture(options.b) ? pictures(options) : volumes(options, common);
  if (options.json)
    fmt::print("{}\n", result.dump(2));
  else
    print(result);
  common.writeStats(result);
  if (!options.out.empty()) writeSideBySide(options);
  std::fflush(stdout);
  options.limits.apply(result);
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  options.limits.check();
  common.checkOutputs({options.out});
  options.a.rawLayout();
  return [&] { run(options, common); };
}

} // namespace

void addDiff(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "diff", "Compares two pictures (.exr, .png), or two volumes in any form; A is the reference");
  options->a.addTo(*command, "A");
  command->add_option("B", options->b, "What to compare with it")->required()->type_name("");
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--component", options->component, "Volumes: which component, from 0")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--points", options->points, "Random points, where A is no plain volume or sizes differ")
      ->check(CLI::Range(1L, 1000000000L))
      ->capture_default_str();
  command->add_option("--out", options->out, "Pictures: write A, B and their absolute difference side by side")
      ->type_name("OUT.png");
  command->add_option("--fail-above", options->limits.above, "Exit with 1 if a metric is above a value: max=0.5")
      ->type_name("METRIC=VALUE");
  command->add_option("--fail-below", options->limits.below, "Exit with 1 if a metric is below a value: psnr=40")
      ->type_name("METRIC=VALUE");
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
