#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volume/hbProgress.h"

/// A program of the system that is run as a child process: no shell comes between, so arguments need no quoting.
///
/// The child gets the caller's environment and folder, and a process group of its own, so that cancelling ends what it
/// started as well. All members may be called from any thread.
class hbExternalProgram {
public:
  /// How a run ended, and what the program wrote.
  struct Result {
    int status = 0; ///< The exit status, 0 to 255; 128 + the signal's number where a signal ended it, as in a shell.
    int signal = 0; ///< The signal that ended it, 0 for none.
    std::string output; ///< Everything written to standard output.
    std::string errors; ///< Everything written to standard error.

    /// The last line of `errors` that is not blank; "nothing" where there is none.
    std::string lastLine() const;
  };

  /// The first executable regular file of that name: in `folders` in their order, then along PATH. A name with a slash
  /// is a path and is taken as it is. None where there is no such file.
  static std::optional<hbExternalProgram> find(std::string_view name,
                                               const std::vector<std::filesystem::path>& folders = {});

  const std::filesystem::path& path() const { return path_; }

  /// Runs it to its end with `input` at its standard input, whatever its exit status. Input, output and errors may have
  /// any size; they are held in memory. Throws hbError where the program cannot be started, and hbCancelled, the
  /// program being killed, within 0.1 s of progress.cancel().
  Result run(const std::vector<std::string>& arguments, std::string_view input = {},
             hbProgress& progress = hbProgress::none()) const;

  /// The same for a program that has to succeed: its output. Throws hbError with the last line of its errors where the
  /// exit status is not 0.
  std::string output(const std::vector<std::string>& arguments, std::string_view input = {},
                     hbProgress& progress = hbProgress::none()) const;

private:
  explicit hbExternalProgram(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};
