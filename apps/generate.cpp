#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/FieldWriter.h"
#include "apps/Program.h"
#include "volume/hbError.h"

namespace {

struct Options {
  std::string name, out, size = "129";
};

std::string knownFields() {
  std::string text = "Fields and their parameters (NAME[,parameter=value...]):\n";
  for (const auto& field : hbAnalyticField::all()) {
    text += fmt::format("  {:<16}{}", field.name, field.formula);
    for (const auto& [key, value] : field.parameters) text += fmt::format("; {}={}", key, value);
    text += "\n";
  }
  return text;
}

void run(const Options& options, const app::CommonOptions& common) {
  common.checkOutputs({options.out});
  const auto sizes = app::parseSizes(options.size, 3, "--size");
  const auto field = hbAnalyticField::create(options.name)->withSize({sizes[0], sizes[1], sizes[2]});
  const auto start = std::chrono::steady_clock::now();
  app::writeField(*field, field->geometry(), options.out, common);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {} x {} x {} float32 samples of {}\n", options.out, sizes[0], sizes[1], sizes[2],
             field->specification());
  common.writeStats(
      {{"samples", field->geometry().samples()}, {"seconds", seconds}, {"specification", field->specification()}});
}

} // namespace

void addGenerate(CLI::App& program, app::CommonOptions& common) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("generate", "Writes an analytic field as a volume of float32 samples");
  command->add_option("NAME", options->name, "The field, with parameters if wanted: hydrogen,state=2p")
      ->required()
      ->type_name("");
  command->add_option("OUT", options->out, "The volume to write: .nrrd, .vti, or .raw named as stem_XxYxZ_float32.raw")
      ->required()
      ->type_name("");
  command->add_option("--size", options->size, "Samples an axis: N, or XxYxZ")->capture_default_str();
  command->footer(knownFields());
  command->callback([options, &common] { run(*options, common); });
}
