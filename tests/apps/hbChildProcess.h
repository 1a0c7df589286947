#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/types.h>

/// The built program as a child process that runs while the test does something else. Destroyed, it kills the child.
class hbChildProcess {
public:
  /// What the child is put under; -1: it shares the test's own stream.
  struct Place {
    std::string folder; ///< Where it runs; "": here.
    int out = -1, err = -1;
    std::optional<std::uint64_t> fileBytes; ///< The largest file it may write.
  };

  /// Starts `hbvol arguments...`.
  hbChildProcess(std::vector<std::string> arguments, const Place& place);
  ~hbChildProcess();
  hbChildProcess(const hbChildProcess&) = delete;
  hbChildProcess& operator=(const hbChildProcess&) = delete;

  pid_t id() const { return child_; }
  void signal(int number) const;
  /// Whether it has not ended yet.
  bool running();
  /// Waits for its end: its exit code, or minus the signal that ended it.
  int wait();
  /// What it used, known when it has ended.
  const rusage& usage() const { return usage_; }

private:
  bool look(int options);

  pid_t child_ = -1;
  std::optional<int> result_;
  rusage usage_{};
};
