#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/CavityRun.h"
#include "apps/FieldWriter.h"
#include "apps/Program.h"
#include "volume/hbError.h"

namespace {

struct Options {
  std::string name, out, size;
  std::int64_t steps = 0;
};

std::string knownFields() {
  std::string text = "Fields and their parameters (NAME[,parameter=value...]):\n";
  for (const auto& field : hbAnalyticField::all()) {
    text += fmt::format("  {:<16}{}", field.name, field.formula);
    for (const auto& [key, value] : field.parameters) text += fmt::format("; {}={}", key, value);
    text += "\n";
  }
  text += fmt::format("Simulated, for generate only (--size: odd, {} to {}):\n  {:<16}a heated cube under a moving lid",
                      hbCavityFlow::kFewest, hbCavityFlow::kMost, hbCavitySpecification::kName);
  for (const auto& [key, value] : hbCavitySpecification::defaults()) text += fmt::format("; {}={}", key, value);
  return text + "; max-steps is for the steady flow only\n";
}

void writeAnalytic(const Options& options, const std::shared_ptr<const hbAnalyticField>& field,
                   const app::CommonOptions& common) {
  const hbSize3 size = field->geometry().size;
  const auto start = std::chrono::steady_clock::now();
  app::writeField(*field, hbSubLattice(field->geometry()), options.out, common);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {} x {} x {} float32 samples of {}\n", options.out, size.x, size.y, size.z, field->specification());
  common.writeStats(
      {{"samples", field->geometry().samples()}, {"seconds", seconds}, {"specification", field->specification()}});
}

app::Work prepareCavity(const Options& options, const app::CommonOptions& common) {
  const auto specification = hbCavitySpecification::parse(options.name);
  const auto sizes = app::parseSizes(options.size.empty() ? "65" : options.size, 3, "--size");
  if (sizes[0] != sizes[1] || sizes[0] != sizes[2])
    throw hbError(fmt::format("--size: expected one number of nodes for the cavity's cube, found '{}'", options.size));
  hbCavityFlow::check(specification.flow, sizes[0]);
  return [&options, &common, specification, nodes = sizes[0]] {
    app::runCavity(specification, nodes, options.steps, options.out, common);
  };
}

app::Work prepareAnalytic(const Options& options, const app::CommonOptions& common) {
  if (options.steps > 0)
    throw hbError(fmt::format("--steps: expected a field that changes with time ({}), found '{}'",
                              hbCavitySpecification::kName, options.name));
  common.checkOutputs({options.out});
  const auto sizes = app::parseSizes(options.size.empty() ? "129" : options.size, 3, "--size");
  const auto field = hbAnalyticField::create(options.name)->withSize({sizes[0], sizes[1], sizes[2]});
  return [&options, &common, field] { writeAnalytic(options, field, common); };
}

} // namespace

void addGenerate(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("generate", "Writes an analytic or simulated field as a volume of float32 samples");
  command->add_option("NAME", options->name, "The field, with parameters if wanted: hydrogen,state=2p")
      ->required()
      ->type_name("");
  command->add_option("OUT", options->out, "The volume to write: .nrrd, .vti, or .raw named as stem_XxYxZ_float32.raw")
      ->required()
      ->type_name("");
  command->add_option("--size", options->size, "Samples an axis: N, or XxYxZ (default: 129; 65 for the cavity)");
  command
      ->add_option("--steps", options->steps,
                   "Write that many volumes of a simulation, at equal times up to its end-time (default then: 20), as "
                   "stem_0000.ext and so on")
      ->check(CLI::Range(1, 100000))
      ->type_name("T");
  command->footer(knownFields());
  command->callback([options, &common, &work] {
    const bool simulated = hb::fieldName(options->name) == hbCavitySpecification::kName;
    work = (simulated ? prepareCavity : prepareAnalytic)(*options, common);
  });
}
