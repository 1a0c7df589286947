#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/ChoiceOption.h"
#include "apps/CompressionText.h"
#include "apps/FitOptions.h"
#include "apps/IndexSetOptions.h"
#include "apps/Program.h"
#include "report/hbFitJson.h"
#include "report/hbSparseCompression.h"
#include "sparsegrid/hbComponentFiles.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;
using Measure = hbSparseCompression::Measure;

struct Options {
  app::InputOptions input;
  std::vector<std::string> files; ///< IN OUT, or OUT alone with --components
  std::string components;
  app::IndexSetOptions set;
  app::FitOptions fit;
  hbSparseCompression how;
};

void checkNames(const Options& options) {
  if (options.components.empty() && options.files.size() != 2)
    throw CLI::ValidationError("compress", "expected IN and OUT.hbv");
  if (!options.components.empty() && options.files.size() != 1)
    throw CLI::ValidationError("--components", "expected OUT.hbv alone beside it");
  if (app::extension(options.files.back()) != ".hbv")
    throw hbError(fmt::format("{}: expected a name that ends with .hbv", options.files.back()));
}

void run(Options& options, const app::CommonOptions& common) {
  const std::string out = options.files.back();
  const auto start = std::chrono::steady_clock::now();
  hbInput input;
  options.how.set = options.set.choice();
  options.how.nonFinite = options.input.nanValue;
  options.how.memoryLimit = common.memoryLimit();
  if (options.how.fit && options.how.fit->keepBest) app::waitAfterInterrupt();
  const auto build = [&]() -> hbSparseCompression::Result {
    if (options.components.empty()) {
      input = options.input.open(options.files.front(), common, app::progress());
      return options.how.compress(input, app::progress());
    }
    input.name = options.components;
    hbReadOptions read;
    read.memoryLimit = common.memoryLimit();
    return {{hb::readComponentGrids(options.components, read, app::progress()), {}, {}, {}, {}}, {}};
  };
  hbSparseCompression::Result result = build();
  hbSparseGridFile& file = result.file;
  Json provenance{{"program", "hbvol " HBVOL_VERSION},
                  {"source", std::filesystem::path(input.name).filename().string()}};
  if (input.analytic) provenance["field"] = input.analytic->specification();
  for (const hbFitReport& fit : result.fits) provenance["fit"].push_back(hb::provenanceOf(fit));
  file.provenance.json = provenance.dump(-1, ' ', true, Json::error_handler_t::replace);
  file.write(out);

  Json stats = app::compressionStatistics(result, input.fileBytes, std::filesystem::file_size(out));
  stats["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  app::printCompression(out, stats, result);
  common.writeStats(stats);
}

app::Work prepare(Options& options, const CLI::App& command, const app::CommonOptions& common) {
  checkNames(options);
  common.checkOutputs({options.files.back()});
  options.input.rawLayout();
  options.set.check();
  options.how.fit = options.fit.choice(command);
  if (options.how.fit && !options.components.empty())
    throw CLI::ValidationError("--fit", "expected samples to fit, found --components");
  return [&] { run(options, common); };
}

} // namespace

void addCompress(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  hbSparseCompression& how = options->how;
  CLI::App* command = program.add_subcommand("compress", "Turns a volume or field into a sparse grid");
  command
      ->add_option("FILES", options->files,
                   "IN OUT.hbv; IN is a volume file, a folder of DICOM slices or field:NAME[,...]")
      ->required()
      ->type_name("");
  options->set.addTo(*command);
  options->fit.addTo(*command);
  app::addChoice(*command, "--mapping", how.mapping,
                 {{"fitted", hbLatticeMapping::fitted}, {"aligned", hbLatticeMapping::aligned}},
                 "fitted (default): the grid's cube is the volume's; aligned: grid nodes are samples");
  command
      ->add_option("--components", options->components,
                   "Build from a solver's component grids: 'u_{i}_{j}_{k}.nrrd' (quoted), then OUT.hbv alone")
      ->type_name("PATTERN");
  app::addChoice(
      *command, "--measure", how.measure,
      {{"auto", Measure::automatic}, {"all", Measure::all}, {"sampled", Measure::sampled}, {"none", Measure::none}},
      "Errors against all samples, 2^17 random ones (fields: 2^20 points), or none; auto (default): all samples up to "
      "2^26");
  options->input.addReadTo(*command);
  command->callback([options, command, &common, &work] { work = prepare(*options, *command, common); });
}
