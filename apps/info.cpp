#include <algorithm>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/InfoJson.h"
#include "apps/InfoText.h"
#include "apps/Program.h"
#include "raycast/hbSceneDefaults.h"
#include "sparsegrid/hbIndexSetFile.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

struct Options {
  app::InputOptions input;
  bool json = false, verify = false, histogram = false, uncapped = false, indexSet = false;
  int level = 0;
};

/// Statistics read every sample: up to this many they are shown unasked, beyond only with --histogram.
constexpr std::int64_t kStatisticsUnasked = std::int64_t{1} << 27;

/// The set of a sparse grid, or of the one of a level.
hbIndexSet indexSetOf(const Options& options, const hbInput& input) {
  if (input.sparse && options.level != 0)
    throw hbError(fmt::format("{}: --level says what a sparse grid would hold; this is one", input.name));
  if (input.sparse) return input.sparse->grid.indexSet();
  const hbSize3 size = input.geometry().size;
  const bool capped = input.volume && !options.uncapped;
  return hbIndexSet::regular(options.level, capped ? hbIndexSet::axesOf(size) : hbIndexSet::uncappedAxesOf(size));
}

Json describe(const Options& options, const app::CommonOptions& common) {
  const hbInput input = options.input.open(common, app::progress());
  Json info{{"name", input.name}, {"representation", input.representation()}, {"level", nullptr}};
  const hbSize3 size = input.geometry().size;
  info["dims"] = {size.x, size.y, size.z};
  info["samples"] = input.geometry().samples();
  info["components"] = input.components();
  info["file_bytes"] = input.fileBytes;
  info["format_version"] = nullptr;
  info["stored_values"] = input.geometry().samples();
  info["component_grids"] = nullptr;
  std::vector<hbHistogram> histograms;
  if (input.volume) {
    const hbVolume& volume = *input.volume;
    info["type"] = hb::sampleTypeName(volume.type());
    info["slope"] = volume.slope();
    info["intercept"] = volume.intercept();
    info["component_names"] = volume.componentNames();
    if (options.histogram || volume.geometry().samples() * volume.components() <= kStatisticsUnasked)
      histograms = hb::calcHistograms(volume, 64, app::progress());
  } else if (input.sparse) {
    const hbSparseGridFile& file = *input.sparse;
    app::addSparseGrid(info, file);
    info["format_version"] = fmt::format("{}.{}", hb::kContainerMajor, input.container->header().minor);
    info["bits_per_sample"] = 8.0 * double(input.fileBytes) / double(input.geometry().samples() * input.components());
    if (options.verify) {
      input.container->verify(app::progress());
      info["verified"] = true;
    }
  } else {
    info["specification"] = input.analytic->specification();
  }
  if (options.verify && !input.sparse) throw hbError(fmt::format("{}: --verify expects an .hbv file", input.name));
  if (options.level != 0) app::addIndexSet(info, indexSetOf(options, input), input.geometry(), input.components());
  if (options.histogram && !input.volume)
    for (int c = 0; c < input.components(); ++c)
      histograms.push_back(hb::fieldHistogram(*options.input.field(input, "auto", common), c, app::progress()));
  for (const hbHistogram& h : histograms) info["statistics"].push_back(app::histogramJson(h));
  info["geometry"] = app::geometryJson(input.geometry());
  return info;
}

void listIndexSet(const Options& options, const app::CommonOptions& common) {
  const hbInput input = options.input.open(common, app::progress());
  if (!input.sparse && options.level == 0)
    throw hbError(fmt::format("{}: --index-set expects an .hbv file, or --level beside it", input.name));
  const hbIndexSet set = indexSetOf(options, input);
  fmt::print("{}", hbIndexSetFile::text(set));
  Json info{{"name", input.name}};
  app::addIndexSet(info, set, input.geometry(), input.components());
  common.writeStats(info);
}

void run(const Options& options, const app::CommonOptions& common) {
  const Json info = describe(options, common);
  if (options.json)
    fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
  else
    fmt::print("{}", app::infoText(info, options.histogram));
  common.writeStats(info);
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  options.input.rawLayout();
  if (options.indexSet) return [&] { listIndexSet(options, common); };
  return [&] { run(options, common); };
}

} // namespace

void addInfo(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("info", "Says what a file or field holds");
  options->input.addTo(*command);
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--verify", options->verify, "Check every byte of an .hbv file");
  command->add_flag("--histogram", options->histogram, "Show the histogram of the values (reads all of them)");
  command
      ->add_option("--level", options->level,
                   "Also say what a sparse grid of this level would hold, without building it")
      ->check(CLI::Range(1, hbIndexSet::kMaxLevel));
  command->add_flag("--uncapped", options->uncapped,
                    "With --level: do not stop at the level that resolves the samples");
  command
      ->add_flag("--index-set", options->indexSet,
                 "Print nothing but the index set of an .hbv file, or of --level, as compress --index-set reads it")
      ->excludes("--json")
      ->excludes("--verify")
      ->excludes("--histogram");
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
