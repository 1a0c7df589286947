#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/FitOptions.h"
#include "apps/IndexSetOptions.h"
#include "apps/Program.h"
#include "report/hbFitJson.h"
#include "report/hbReportJson.h"
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

Json statistics(const hbSparseGridFile& file, std::uint64_t inputBytes, std::uint64_t outputBytes) {
  const hbSparseGrid& grid = file.grid;
  const std::int64_t samples = grid.geometry().samples();
  Json stats{{"representation", "sparse"},
             {"level", grid.indexSet().number()},
             {"input_bytes", inputBytes},
             {"output_bytes", outputBytes},
             {"samples", samples},
             {"components", grid.components()},
             {"stored_values", grid.indexSet().storedValues()},
             {"bits_per_sample", 8.0 * double(outputBytes) / double(samples * grid.components())},
             {"psnr", nullptr},
             {"rmse", nullptr},
             {"max_error", nullptr},
             {"max_error_bound", nullptr}};
  if (!file.error) return stats;
  // The worst component speaks for the file; `info --json` has them all.
  const auto& all = file.error->components;
  const auto worst =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.psnr < b.psnr; });
  stats["psnr"] = hb::finiteOrNull(worst->psnr);
  stats["rmse"] = hb::finiteOrNull(worst->rmse);
  stats["max_error"] = hb::finiteOrNull(worst->max);
  return stats;
}

void print(const std::string& out, const Json& stats, const hbSparseGridFile& file) {
  fmt::print("{}: level {}, {} stored values for {} samples, {}, {:.4g} bits a sample\n", out,
             file.grid.indexSet().number(), file.grid.indexSet().storedValues(), file.grid.geometry().samples(),
             app::bytesText(stats["output_bytes"].get<double>()), stats["bits_per_sample"].get<double>());
  constexpr const char* kReferences[] = {"samples", "random samples", "random points of the field"};
  if (file.error)
    for (const auto& c : file.error->components)
      fmt::print("error against {} {}: max {:.6g}, RMSE {:.6g}, PSNR {}\n", c.points,
                 kReferences[std::size_t(c.reference)], c.max, c.rmse,
                 std::isnan(c.psnr) ? "n/a (one value only)" : fmt::format("{:.2f} dB", c.psnr));
}

void print(const hbFitReport& fit) {
  fmt::print("{} on {} samples held out: RMSE {:.6g}, interpolation {:.6g}{}\n", fit.method, fit.heldOut,
             fit.heldOutErrors.rmse, fit.interpolationHeldOutErrors.rmse,
             fit.improved ? "" : "; no better, interpolation was kept");
  fmt::print("fitted to {} samples by {}: RMSE {:.6g}", fit.samples, fit.solver, fit.fitted.rmse);
  if (fit.loss.kind != hbFitLoss::Kind::none) fmt::print(", {} from {:.3g} on", fit.loss.name(), fit.loss.threshold);
  if (fit.smoothing > 0.0) fmt::print(", smoothing {:.3g}", fit.smoothing);
  if (std::isfinite(fit.condition)) fmt::print(", condition about {:.3g}", fit.condition);
  fmt::print(", {} iterations{}, {:.2f} s\n", fit.iterations,
             fit.interrupted ? ", interrupted"
             : fit.converged ? ""
                             : ", not converged",
             fit.seconds);
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
  auto [file, fits] = build();
  Json provenance{{"program", "hbvol " HBVOL_VERSION},
                  {"source", std::filesystem::path(input.name).filename().string()}};
  if (input.analytic) provenance["field"] = input.analytic->specification();
  for (const hbFitReport& fit : fits) provenance["fit"].push_back(hb::provenanceOf(fit));
  file.provenance.json = provenance.dump(-1, ' ', true, Json::error_handler_t::replace);
  file.write(out);

  Json stats = statistics(file, input.fileBytes, std::filesystem::file_size(out));
  stats["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const hbFitReport& fit : fits) stats["fit"].push_back(hb::toJson(fit));
  print(out, stats, file);
  for (const hbFitReport& fit : fits) print(fit);
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
  const std::map<std::string, hbLatticeMapping> mappings{{"fitted", hbLatticeMapping::fitted},
                                                         {"aligned", hbLatticeMapping::aligned}};
  command
      ->add_option("--mapping", how.mapping,
                   "fitted (default): the grid's cube is the volume's; aligned: grid nodes are samples")
      ->transform(CLI::CheckedTransformer(mappings));
  command
      ->add_option("--components", options->components,
                   "Build from a solver's component grids: 'u_{i}_{j}_{k}.nrrd' (quoted), then OUT.hbv alone")
      ->type_name("PATTERN");
  const std::map<std::string, Measure> measures{
      {"auto", Measure::automatic}, {"all", Measure::all}, {"sampled", Measure::sampled}, {"none", Measure::none}};
  command
      ->add_option("--measure", how.measure,
                   "Errors against all samples, 2^17 random ones (fields: 2^20 points), or none; auto (default): all "
                   "samples up to 2^26")
      ->transform(CLI::CheckedTransformer(measures));
  options->input.addReadTo(*command);
  command->callback([options, command, &common, &work] { work = prepare(*options, *command, common); });
}
