// hbvol: compresses 3D scalar volumes, renders from the compressed form, and says what that costs and loses.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <new>
#include <string>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include "apps/Program.h"
#include "volume/hbError.h"

namespace {

constexpr int kFailed = 1, kWrongUsage = 2;

std::string commandLine(int count, char** arguments) {
  std::string line = "hbvol";
  for (int i = 1; i < count; ++i) line += fmt::format(" {}", arguments[i]);
  return line;
}

/// On one line, whatever characters a file's name has.
void printError(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
  ::alarm(0); // an interrupt's last resort would say it again
  app::clearProgress();
  std::fputs(("hbvol: error: " + text + "\n").c_str(), stderr); // stderr may be closed: no reason to die
}

int fail(const char* text) {
  printError(text);
  return kFailed;
}

/// Descriptors 0 to 2 that the caller closed would be given to the first files opened, and messages written into them.
void openStandardStreams() {
  for (int file = ::open("/dev/null", O_RDWR); file >= 0; file = ::open("/dev/null", O_RDWR))
    if (file > STDERR_FILENO) {
      ::close(file);
      return;
    }
}

} // namespace

int main(int count, char** arguments) {
  openStandardStreams();
  app::handleInterrupts();
  app::CommonOptions common;
  common.command = commandLine(count, arguments);

  CLI::App program("Compresses 3D scalar volumes into sparse grids, renders X-ray, maximum-intensity and iso-surface\n"
                   "pictures straight from them, and reports speed against error.",
                   "hbvol");
  program.set_version_flag("--version", "hbvol " HBVOL_VERSION);
  program.require_subcommand(1);
  program.footer("Examples:\n"
                 "  hbvol info head.nii.gz --histogram\n"
                 "  hbvol compress head.nii.gz head.hbv --level 8\n"
                 "  hbvol render head.hbv head.png --mode mip --size 800x600\n"
                 "  hbvol render field:hydrogen orbital.exr --mode iso --iso 5\n"
                 "  hbvol diff full.exr sparse.exr --json\n"
                 "Exit status: 0 done, 1 failed (one line on stderr), 2 wrong usage.");
  for (const auto add : {addInfo, addGenerate, addCompress, addExtract, addRender, addProbe, addDiff})
    add(program, common);
  std::unique_ptr<oneapi::tbb::global_control> threads;
  for (CLI::App* command : program.get_subcommands({})) {
    common.addTo(*command);
    command->parse_complete_callback([&] {
      if (common.threads > 0)
        threads = std::make_unique<oneapi::tbb::global_control>(oneapi::tbb::global_control::max_allowed_parallelism,
                                                                common.threads);
    });
  }

  try {
    program.parse(count, arguments);
    if (std::fflush(stdout) != 0) return fail("standard output: cannot be written");
    return 0;
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == 0; // --help, --version
    const auto unknown = program.remaining();      // a mistyped subcommand
    if (!asked)
      printError(fmt::format("{}{} (see hbvol --help)", error.what(),
                             unknown.empty() ? "" : fmt::format(", found '{}'", unknown.front())));
    else
      program.exit(error);
    return asked ? 0 : kWrongUsage;
  } catch (const std::bad_alloc&) {
    return fail("out of memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
