#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/ChoiceOption.h"
#include "apps/FieldWriter.h"
#include "apps/Program.h"
#include "volume/hbError.h"
#include "volume/hbMemoryMonitor.h"
#include "volume/hbOutlierField.h"

namespace {

struct Options {
  app::InputOptions input;
  std::string out, box, size;
  std::optional<int> lod;
  double outliers = 0.0; ///< The share of samples to spoil.
};

/// What the options ask for, read and checked as far as that goes without the input.
struct Selection {
  std::optional<std::pair<hbSize3, hbSize3>> box;
  std::optional<int> lod;
  std::optional<hbSize3> size;

  hbSubLattice of(const hbInput& input) const {
    try {
      hbSubLattice lattice(input.geometry());
      if (box) lattice = lattice.box(box->first, box->second);
      if (lod) lattice = lattice.thinned(*lod);
      if (size) lattice = lattice.resized(*size);
      return lattice;
    } catch (const hbError& error) {
      throw hbError(fmt::format("{}: --{}", input.name, error.what()));
    }
  }
};

std::shared_ptr<const hbField> spoiled(const hbInput& input, std::shared_ptr<const hbField> field, double share) {
  if (!input.volume)
    throw hbError(fmt::format("{}: --outliers: expected a plain volume, whose range is known, found {}", input.name,
                              input.representation()));
  return std::make_shared<hbOutlierField>(std::move(field), share);
}

void run(const Options& options, const Selection& selection, const app::CommonOptions& common) {
  const hbInput input = options.input.open(common, app::progress());
  const hbSubLattice lattice = selection.of(input);
  hbMemoryMonitor memory;
  const auto start = std::chrono::steady_clock::now();
  // Lattices come from a sparse grid as it is: another form would only take memory.
  auto field = options.input.field(input, input.sparse ? "direct" : "full", common);
  if (options.outliers > 0.0) field = spoiled(input, field, options.outliers);
  const std::uint64_t bytes = app::writeField(*field, lattice, options.out, common);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const hbSize3 size = lattice.size();
  fmt::print("{}: {} x {} x {} samples in {:.2f} s\n", options.out, size.x, size.y, size.z, seconds);
  nlohmann::ordered_json stats{{"samples", size.x * size.y * size.z},
                               {"bytes", bytes},
                               {"seconds", seconds},
                               {"memory_growth_bytes", memory.growth()}};
  if (selection.box) stats["box"] = options.box;
  if (selection.lod) stats["lod"] = *selection.lod;
  if (options.outliers > 0.0) stats["outliers"] = options.outliers;
  common.writeStats(stats);
}

app::Work prepare(const Options& options, const app::CommonOptions& common) {
  common.checkOutputs({options.out});
  options.input.rawLayout();
  Selection selection;
  if (!options.box.empty()) selection.box = app::parseBox(options.box, "--box");
  selection.lod = options.lod;
  if (!options.size.empty()) {
    const auto sizes = app::parseSizes(options.size, 3, "--size");
    selection.size = {sizes[0], sizes[1], sizes[2]};
  }
  return [&, selection] { run(options, selection, common); };
}

} // namespace

void addExtract(CLI::App& program, const app::CommonOptions& common, app::Work& work) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "extract", "Writes a compressed volume (or anything else) back as a plain one, slab by "
                 "slab: some 30 MB beside the input (40 MB for several components), however large the output is");
  options->input.addTo(*command);
  command->add_option("OUT", options->out, "The volume to write: .nrrd, .vti, or .raw named as stem_XxYxZ_float32.raw")
      ->required()
      ->type_name("");
  command->add_option("--box", options->box, "Only samples X0 to X1 along x and so on, counted from 0, both included")
      ->type_name("X0:X1,Y0:Y1,Z0:Z1");
  CLI::Option* size = command->add_option("--size", options->size,
                                          "Samples an axis on the same box: N, or XxYxZ (default: the source's)");
  command->add_option("--lod", options->lod, "Every 2^K-th sample an axis from the first one on; at least two an axis")
      ->check(CLI::Range(0, hbSubLattice::kMaxLod))
      ->type_name("K")
      ->excludes(size);
  command
      ->add_option("--outliers", options->outliers,
                   "Spoil that share of the samples with values uniform over their range, to test what becomes of bad "
                   "data; the same ones every time")
      ->check(CLI::Range(0.0, 1.0) & app::isFinite())
      ->type_name("SHARE");
  command->callback([options, &common, &work] { work = prepare(*options, common); });
}
