#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/FieldWriter.h"
#include "apps/Program.h"

namespace {

struct Options {
  app::InputOptions input;
  std::string out, size;
};

void run(const Options& options, const std::optional<hbSize3>& size, const app::CommonOptions& common) {
  const hbInput input = options.input.open(common, app::progress());
  hbGeometry geometry = input.geometry();
  if (size) {
    for (int d = 0; d < 3; ++d) {
      // The box stays; an axis made flat keeps its middle.
      const double edge = geometry.extent()[d];
      if (geometry.isFlat(d)) geometry.origin -= 0.5 * edge * geometry.direction[d];
      geometry.size[d] = (*size)[d];
      geometry.spacing[d] = geometry.isFlat(d) ? edge : edge / double(geometry.size[d] - 1);
      if (geometry.isFlat(d)) geometry.origin += 0.5 * edge * geometry.direction[d];
    }
  }
  const auto start = std::chrono::steady_clock::now();
  // Lattices come from a sparse grid as it is: another form would only take memory.
  app::writeField(*options.input.field(input, input.sparse ? "direct" : "full", common), geometry, options.out, common);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {} x {} x {} samples in {:.2f} s\n", options.out, geometry.size.x, geometry.size.y, geometry.size.z,
             seconds);
  common.writeStats({{"samples", geometry.samples()}, {"seconds", seconds}});
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  common.checkOutputs({options.out});
  options.input.rawLayout();
  std::optional<hbSize3> size;
  if (!options.size.empty()) {
    const auto sizes = app::parseSizes(options.size, 3, "--size");
    size = {sizes[0], sizes[1], sizes[2]};
  }
  return [&, size] { run(options, size, common); };
}

} // namespace

void addExtract(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("extract", "Writes a compressed volume (or anything else) back as a plain one");
  options->input.addTo(*command);
  command->add_option("OUT", options->out, "The volume to write: .nrrd, .vti, or .raw named as stem_XxYxZ_float32.raw")
      ->required()
      ->type_name("");
  command->add_option("--size", options->size, "Samples an axis on the same box: N, or XxYxZ (default: the source's)");
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
