#pragma once

#include <memory>
#include <stdexcept>

#include "apps/Program.h"

namespace app {

/// Arguments that make no command: exit status 2.
class WrongUsage : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The program's command line, all subcommands together.
class CommandLine {
public:
  CommandLine();
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Reads and checks the arguments, the program's name first, and returns the work they ask for (--help and --version
  /// are work, too). Opens no input and writes nothing. The work refers to this object; parse once. Throws WrongUsage,
  /// and hbError for a value that can be read and is wrong.
  Work parse(int count, const char* const* arguments);

private:
  CommonOptions common_;
  Work work_;
  std::unique_ptr<CLI::App> program_;
};

} // namespace app
