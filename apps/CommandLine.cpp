#include "apps/CommandLine.h"

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

app::CommandLine::CommandLine()
    : program_(std::make_unique<CLI::App>(
          "Compresses 3D scalar volumes into sparse grids, renders X-ray, maximum-intensity, iso-surface and\n"
          "emission-absorption pictures straight from them, and reports speed against error.",
          "hbvol")) {
  program_->set_version_flag("--version", "hbvol " HBVOL_VERSION);
  program_->require_subcommand(1);
  program_->footer("Examples:\n"
                   "  hbvol info head.nii.gz --histogram\n"
                   "  hbvol compress head.nii.gz head.hbv --level 8\n"
                   "  hbvol render head.hbv head.png --mode mip --size 800x600\n"
                   "  hbvol render field:hydrogen orbital.exr --mode iso --iso 5\n"
                   "  hbvol diff full.exr sparse.exr --json\n"
                   "Exit status: 0 done, 1 failed (one line on stderr), 2 wrong usage.");
  for (const auto add : {addInfo, addGenerate, addCompress, addExtract, addRender, addProbe, addDiff, addCompare})
    add(*program_, common_, work_);
  for (CLI::App* command : program_->get_subcommands({})) common_.addTo(*command);
}

app::CommandLine::~CommandLine() = default;

app::Work app::CommandLine::parse(int count, const char* const* arguments) {
  common_.command = "hbvol";
  for (int i = 1; i < count; ++i) common_.command += fmt::format(" {}", arguments[i]);
  try {
    program_->parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) // --help, --version
      return [this, error] { program_->exit(error); };
    const auto unknown = program_->remaining(); // a mistyped subcommand
    throw WrongUsage(fmt::format("{}{} (see hbvol --help)", error.what(),
                                 unknown.empty() ? "" : fmt::format(", found '{}'", unknown.front())));
  }
  return [this] {
    using oneapi::tbb::global_control;
    std::optional<global_control> threads;
    if (common_.threads > 0) threads.emplace(global_control::max_allowed_parallelism, common_.threads);
    work_();
  };
}
