#include "report/hbExternalProgram.h"

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

hbExternalProgram shell() { return hbExternalProgram::find("sh").value(); }

hbExternalProgram::Result runShell(const std::string& script, std::string_view input = {}) {
  return shell().run({"-c", script}, input);
}

TEST(hbExternalProgram, missingProgramIsNone) {
  EXPECT_FALSE(hbExternalProgram::find("hbvol-no-such-program"));
  EXPECT_FALSE(hbExternalProgram::find("/no/such/folder/sh"));
  EXPECT_FALSE(hbExternalProgram::find("sh/"));
}

TEST(hbExternalProgram, foldersComeBeforePathAndOnlyExecutableFilesCount) {
  const hbTestFolder folder;
  const auto later = folder / "later";
  std::filesystem::create_directories(folder / "sh"); // a folder of the name is no program
  std::filesystem::create_directories(later);
  std::ofstream(later / "sh") << "#!/bin/sh\necho other\n";
  EXPECT_EQ(hbExternalProgram::find("sh", {folder.path(), later})->path(), shell().path());
  std::filesystem::permissions(later / "sh", std::filesystem::perms::owner_all);
  EXPECT_EQ(hbExternalProgram::find("sh", {folder.path(), later})->path(), later / "sh");
  EXPECT_EQ(hbExternalProgram::find("sh", {folder.path(), later})->output({}), "other\n");
}

TEST(hbExternalProgram, argumentsArriveAsTheyAre) {
  const std::vector<std::string> arguments{"-c",      "printf '[%s]' \"$@\"", "name", "a b", "", "$HOME", "'\"\\",
                                           "\xc3\xa4"};
  EXPECT_EQ(shell().output(arguments), "[a b][][$HOME]['\"\\][\xc3\xa4]");
}

TEST(hbExternalProgram, outputAndErrorsAreKeptApart) {
  const auto result = runShell("echo out; echo err >&2; cat", "input");
  EXPECT_EQ(result.output, "out\ninput");
  EXPECT_EQ(result.errors, "err\n");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.signal, 0);
}

TEST(hbExternalProgram, failureHasItsStatusAndLastLine) {
  const auto result = runShell("echo first >&2; echo 'last one' >&2; exit 7");
  EXPECT_EQ(result.status, 7);
  EXPECT_EQ(result.errors, "first\nlast one\n");
  EXPECT_EQ(result.lastLine(), "last one");
  EXPECT_EQ(runShell("printf 'one\\r\\n \\n' >&2").lastLine(), "one");
  EXPECT_EQ(runShell("echo >&2").lastLine(), "nothing");
  try {
    shell().output({"-c", "echo first >&2; echo 'last one' >&2; exit 7"});
    ADD_FAILURE() << "expected an hbError";
  } catch (const hbError& error) {
    EXPECT_EQ(error.what(), shell().path().string() + ": expected exit status 0, found 7 and the message: last one");
  }
  EXPECT_THROW(shell().output({"-c", "exit 1"}), hbError); // without a message
}

TEST(hbExternalProgram, signalIsToldFromAnExit) {
  const auto result = runShell("kill -TERM $$");
  EXPECT_EQ(result.signal, SIGTERM);
  EXPECT_EQ(result.status, 128 + SIGTERM);
}

TEST(hbExternalProgram, whatCannotBeStartedIsAnError) {
  const hbTestFolder folder;
  std::ofstream(folder / "broken") << "#!/no/such/interpreter\n";
  std::filesystem::permissions(folder / "broken", std::filesystem::perms::owner_all);
  const auto program = hbExternalProgram::find("broken", {folder.path()});
  ASSERT_TRUE(program);
  EXPECT_THROW(program->run({}), hbError);
}

TEST(hbExternalProgram, inputAndOutputBeyondAPipesBufferDoNotBlock) {
  const std::string input(std::size_t(3) << 20, 'x');
  const auto result = runShell("tee /dev/stderr", input);
  EXPECT_TRUE(result.output == input) << result.output.size();
  EXPECT_TRUE(result.errors == input) << result.errors.size();
  EXPECT_EQ(runShell("exit 3", input).status, 3); // input that is not read
  EXPECT_EQ(runShell("head -c 5", input).output, "xxxxx");
}

TEST(hbExternalProgram, programThatClosesItsOutputIsWaitedFor) {
  EXPECT_EQ(runShell("exec >&- 2>&-; sleep 0.05; exit 4").status, 4);
}

/// Cancels as soon as the file appears, that is, once the program runs.
class CancelWhenStarted {
public:
  CancelWhenStarted(hbProgress& progress, std::filesystem::path file)
      : thread_([this, &progress, file = std::move(file)] {
          while (!stop_ && !std::filesystem::exists(file)) std::this_thread::yield();
          progress.cancel();
        }) {}
  ~CancelWhenStarted() {
    stop_ = true;
    thread_.join();
  }

private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST(hbExternalProgram, cancellingKillsTheProgramAndWhatItStarted) {
  const hbTestFolder folder;
  hbProgress progress;
  {
    CancelWhenStarted cancel(progress, folder / "started");
    // The grandchild writes its id before it sleeps for longer than the test may take.
    const std::string script = "cd '" + folder.path().string() + "'; sleep 1000 & echo $! >id; mv id started; wait";
    EXPECT_THROW(shell().run({"-c", script}, {}, progress), hbCancelled);
  }
  std::ifstream file(folder / "started");
  pid_t id = 0;
  ASSERT_TRUE(file >> id);
  // A killed grandchild vanishes, or stays as a zombie until somebody collects it.
  const auto living = [id] {
    std::ifstream stat("/proc/" + std::to_string(id) + "/stat");
    std::string pid, name, state;
    return bool(stat >> pid >> name >> state) && state != "Z" && state != "X";
  };
  while (living()) std::this_thread::yield(); // the test's time limit is the failure
}

TEST(hbExternalProgram, cancelledBeforehandNothingIsStarted) {
  const hbTestFolder folder;
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(shell().run({"-c", "touch '" + (folder / "started").string() + "'"}, {}, progress), hbCancelled);
  EXPECT_FALSE(std::filesystem::exists(folder / "started"));
}

} // namespace
