#include "tests/apps/hbProgramRun.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include "tests/apps/hbChildProcess.h"

namespace {

using Clock = std::chrono::steady_clock;

/// A pipe whose ends close themselves.
struct Pipe {
  std::array<int, 2> ends{-1, -1};

  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }

  /// Takes what there is; false at the end.
  bool read(std::string& text) {
    std::array<char, 65536> buffer;
    const ssize_t count = ::read(ends[0], buffer.data(), buffer.size());
    if (count > 0) text.append(buffer.data(), std::size_t(count));
    if (count == 0) close(0);
    return count > 0;
  }
};

/// Whether the process handles SIGINT by now.
bool catchesInterrupts(pid_t child) {
  std::ifstream status(fmt::format("/proc/{}/status", child));
  for (std::string word; status >> word;)
    if (word == "SigCgt:") {
      status >> word;
      return (std::stoull(word, nullptr, 16) >> (SIGINT - 1) & 1U) != 0;
    }
  return false;
}

double secondsSince(Clock::time_point from) { return std::chrono::duration<double>(Clock::now() - from).count(); }

} // namespace

hbProgramRun::hbProgramRun(std::vector<std::string> arguments, const Conditions& conditions)
    : arguments_(std::move(arguments)) {
  Pipe outPipe, errPipe;
  hbChildProcess child(arguments_, {conditions.folder, outPipe.ends[1], errPipe.ends[1], conditions.fileBytes});
  outPipe.close(1);
  errPipe.close(1);

  const Clock::time_point start = Clock::now();
  std::optional<Clock::time_point> ready, interrupted;
  bool killed = false;
  constexpr double kBeforeInterrupt = 0.5;
  constexpr int kPollMilliseconds = 20;
  while (outPipe.ends[0] >= 0 || errPipe.ends[0] >= 0) {
    if (conditions.interrupt && !interrupted) {
      if (!ready && catchesInterrupts(child.id())) ready = Clock::now();
      if (ready && secondsSince(*ready) > kBeforeInterrupt) {
        interrupted = Clock::now();
        child.signal(SIGINT);
      }
    }
    if (!killed && secondsSince(start) > conditions.limitSeconds) {
      killed = true;
      child.signal(SIGKILL);
    }
    std::array<pollfd, 2> both{{{outPipe.ends[0], POLLIN, 0}, {errPipe.ends[0], POLLIN, 0}}};
    if (::poll(both.data(), both.size(), kPollMilliseconds) < 0 && errno != EINTR) break;
    if (both[0].revents != 0) outPipe.read(out);
    if (both[1].revents != 0) errPipe.read(err);
  }
  exitCode = child.wait();
  if (interrupted) secondsAfterInterrupt = secondsSince(*interrupted);
  peakBytes = std::int64_t{child.usage().ru_maxrss} * 1024;
  EXPECT_FALSE(killed) << "not done after " << conditions.limitSeconds << " s: " << text();
  EXPECT_GE(exitCode, 0) << text();
}

nlohmann::json hbProgramRun::json() const {
  const auto parsed = nlohmann::json::parse(out, nullptr, false);
  EXPECT_FALSE(parsed.is_discarded()) << text() << out;
  return parsed;
}

std::string hbProgramRun::text() const {
  return fmt::format("hbvol {}\nexit {}, stderr:\n{}\n", fmt::join(arguments_, " "), exitCode, err);
}

bool hbProgramRun::saysNothingButOneError() const {
  return err.starts_with("hbvol: error: ") && err.ends_with('\n') && std::count(err.begin(), err.end(), '\n') == 1;
}

bool hbProgramRun::mentions(std::string_view words) const { return err.find(words) != std::string::npos; }
