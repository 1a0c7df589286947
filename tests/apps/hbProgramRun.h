#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

/// One run of the built program as a child process, and what came of it.
class hbProgramRun {
public:
  /// What the child is put under.
  struct Conditions {
    std::string folder;                     ///< Where it runs; "": here.
    std::optional<std::uint64_t> fileBytes; ///< The largest file it may write, as a full disk would stop it.
    bool interrupt = false;                 ///< SIGINT half a second after it is ready for one.
    int limitSeconds = 120;                 ///< It is killed after that, which fails the test.
  };

  /// Runs `hbvol arguments...` to its end.
  explicit hbProgramRun(std::vector<std::string> arguments) : hbProgramRun(std::move(arguments), Conditions()) {}
  hbProgramRun(std::vector<std::string> arguments, const Conditions& conditions);

  int exitCode = -1; ///< Minus the signal that ended it.
  std::string out, err;
  std::int64_t peakBytes = 0;            ///< Of its resident memory.
  double secondsAfterInterrupt = 0.0;    ///< From the interrupt to its end.
  nlohmann::json json() const;           ///< Its standard output; fails the test where that is no JSON.
  std::string text() const;              ///< Command line, exit code and stderr, for messages.
  bool saysNothingButOneError() const;   ///< Whether stderr is one whole line beginning "hbvol: error: ".
  bool mentions(std::string_view) const; ///< Whether stderr contains that.

private:
  std::vector<std::string> arguments_;
};

/// Expects a run that did what it was asked for, without a word on stderr.
#define EXPECT_RUNS(run)                                                                                               \
  do {                                                                                                                 \
    const hbProgramRun& hbRun = (run);                                                                                 \
    EXPECT_EQ(hbRun.exitCode, 0) << hbRun.text();                                                                      \
    EXPECT_EQ(hbRun.err, "") << hbRun.text();                                                                          \
  } while (false)

/// Expects a run that failed with `code` and one line on stderr that contains `words`.
#define EXPECT_FAILS(run, code, words)                                                                                 \
  do {                                                                                                                 \
    const hbProgramRun& hbRun = (run);                                                                                 \
    EXPECT_EQ(hbRun.exitCode, code) << hbRun.text();                                                                   \
    EXPECT_TRUE(hbRun.saysNothingButOneError()) << hbRun.text();                                                       \
    EXPECT_TRUE(hbRun.mentions(words)) << hbRun.text() << "expected: " << (words);                                     \
  } while (false)
