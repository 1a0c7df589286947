// What is left when the program is killed, when the disk is full, and what a reader sees while a writer runs. No
// verdict depends on when something happened: whatever the moment, the old file or the new one is there, whole.

#include <array>
#include <chrono>
#include <csignal>
#include <random>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "tests/apps/hbAppTest.h"
#include "tests/apps/hbChildProcess.h"

namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::byte>;
namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitized program takes up to a second to start.
constexpr int kMoments = 12, kWrites = 6;
#else
constexpr int kMoments = 50, kWrites = 30;
#endif

} // namespace

class fault : public hbAppTest {
protected:
  /// Noise, so that packing and writing it takes a while.
  void writeNoise(const std::string& name, std::int64_t side, unsigned seed) const {
    std::mt19937 random(seed);
    writeVolume<float>(name, {side, side, side}, 1, [&](auto, auto, auto, int) { return double(random()); });
  }

  hbChildProcess start(const std::vector<std::string>& arguments) const {
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    return {arguments, {folder_.path().string(), nothing, nothing, {}}};
  }

  /// Where a child writes before it renames, as doc/files.md says.
  fs::path temporary(const fs::path& target, const hbChildProcess& child) const {
    return folder_ / fmt::format(".{}.{}-0.tmp{}", target.stem().string(), child.id(), target.extension().string());
  }

  /// Waits until the child has begun to write `target`, or has ended.
  void awaitWrite(hbChildProcess& child, const fs::path& target) const {
    while (!fs::exists(temporary(target, child)) && child.running()) ::usleep(50);
  }

  /// Runs the command, which replaces the file `target` by one that differs, and kills it at moments that are spread
  /// over the time from the temporary file's birth to its renaming.
  void killWhileWriting(const std::vector<std::string>& command, const std::string& target, int moments) {
    const Bytes old = bytes(target);
    Clock::duration duration{};
    {
      hbChildProcess child = start(command);
      awaitWrite(child, target);
      const auto begin = Clock::now();
      while (fs::exists(temporary(target, child))) ::usleep(50);
      duration = Clock::now() - begin;
      ASSERT_EQ(child.wait(), 0);
    }
    const Bytes fresh = bytes(target);
    ASSERT_NE(fresh, old);

    std::mt19937 random(20261122);
    // A little further than the end.
    std::uniform_real_distribution<double> share(0.0, 1.1);
    int killed = 0, beforeRenaming = 0;
    fs::path kept;
    // On a busy machine all of them may come too late: then more are tried at once, until one hits.
    for (int i = 0; i < moments || (beforeRenaming == 0 && i < moments + 500); ++i) {
      hb::test::writeFile(folder_ / target, old);
      hbChildProcess child = start(command);
      awaitWrite(child, target);
      const auto wait = duration * (i == 0 || i >= moments ? 0.0 : share(random));
      ::usleep(useconds_t(std::chrono::duration_cast<std::chrono::microseconds>(wait).count()));
      child.signal(SIGKILL);
      const bool dead = child.wait() == -SIGKILL;
      killed += dead ? 1 : 0;

      const Bytes found = bytes(target);
      const fs::path left = temporary(target, child);
      ASSERT_TRUE(found == old || found == fresh) << "moment " << i << ": neither the old file nor the new one";
      ASSERT_TRUE(dead || found == fresh) << "moment " << i;
      if (!fs::exists(left)) continue;
      // Killed before the renaming: the target is the old one, and what is beside it does not pass for a whole one.
      ++beforeRenaming;
      EXPECT_TRUE(found == old) << "moment " << i;
      if (target.ends_with(".hbv") && hb::test::readFile(left) != fresh)
        EXPECT_FAILS(run({"info", left.string(), "--verify"}), 1, left.filename().string());
      if (kept.empty())
        kept = left; // in the way of all that follow
      else
        fs::remove(left);
    }
    RecordProperty("killed", killed);
    RecordProperty("killedBeforeRenaming", beforeRenaming);
    fmt::print("{}: {} of {} killed, {} of them before the renaming, over {:.1f} ms\n", command.front(), killed,
               moments, beforeRenaming, std::chrono::duration<double, std::milli>(duration).count());
    EXPECT_GT(beforeRenaming, 0);

    // What a killed run left is in nobody's way, and is left alone.
    EXPECT_RUNS(run(command));
    EXPECT_EQ(bytes(target), fresh);
    EXPECT_TRUE(fs::remove(kept));
  }
};

TEST_F(fault, KilledCompressLeavesTheOldFileOrTheNewOne) {
  writeNoise("a.nrrd", 65, 1);
  writeNoise("b.nrrd", 65, 2);
  const auto compress = [&](const char* in) -> std::vector<std::string> {
    return {"compress", in, "x.hbv", "--index-set", "full", "--measure", "none"};
  };
  EXPECT_RUNS(run(compress("b.nrrd")));
  EXPECT_RUNS(run({"info", "x.hbv", "--verify"}));
  killWhileWriting(compress("a.nrrd"), "x.hbv", kMoments);
  EXPECT_RUNS(run({"info", "x.hbv", "--verify"}));
}

TEST_F(fault, KilledExtractAndRenderLeaveTheOldFileOrTheNewOne) {
  EXPECT_RUNS(run({"compress", "field:smooth", "s.hbv", "--level", "6", "--measure", "none"}));
  write("x.nrrd", "old\n");
  killWhileWriting({"extract", "s.hbv", "x.nrrd", "--size", "97"}, "x.nrrd", kMoments / 3);
  write("x.exr", "old\n");
  killWhileWriting({"render", "s.hbv", "x.exr", "--size", "400x400", "--samples", "4"}, "x.exr", kMoments / 3);
}

TEST_F(fault, ADiskThatFillsAtAnyByteLeavesTheOldFile) {
  EXPECT_RUNS(run({"compress", "field:smooth", "new.hbv", "--level", "3", "--measure", "none"}));
  const Bytes fresh = bytes("new.hbv");
  write("x.hbv", "old\n");
  hbProgramRun::Conditions full;
#ifdef __SANITIZE_THREAD__
  constexpr std::size_t kLeast = 1; // the thread sanitizer writes a byte of its own before the program begins
#else
  constexpr std::size_t kLeast = 0;
#endif
  // Before the header, in it, in the chunks, in the table, and one byte short.
  for (const std::size_t room : {kLeast, std::size_t{2}, std::size_t{64}, std::size_t{65}, fresh.size() / 2,
                                 fresh.size() - 80, fresh.size() - 1}) {
    full.fileBytes = room;
    expectFailureLeavesAll({"compress", "field:smooth", "x.hbv", "--level", "3", "--measure", "none"}, 1,
                           "x.hbv: cannot be written: File too large", full);
  }
  full.fileBytes = fresh.size();
  EXPECT_RUNS(run({"compress", "field:smooth", "x.hbv", "--level", "3", "--measure", "none"}, full));
  EXPECT_EQ(bytes("x.hbv"), fresh);
}

TEST_F(fault, AFullStandardOutputIsAnError) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"info", "field:ball"}, {"info", "field:ball", "--json"}, {"--help"}, {"--version"}}) {
    hbChildProcess child(arguments, {folder_.path().string(), full, full, {}});
    EXPECT_EQ(child.wait(), 1) << arguments.front();
  }
  ::close(full);
}

TEST_F(fault, AReaderBesideAWriterSeesWholeFiles) {
  writeNoise("a.nrrd", 33, 1);
  writeNoise("b.nrrd", 25, 2);
  write("points.txt", "0.2 0.3 0.4\n0.5 0.5 0.5\n");
  const std::vector<std::string> info{"info", "x.hbv", "--json", "--verify"},
      probe{"probe", "x.hbv", "--points", "points.txt", "--space", "cube"};
  const auto compress = [&](bool odd) -> std::vector<std::string> {
    return {"compress", odd ? "a.nrrd" : "b.nrrd", "x.hbv", "--index-set", "full", "--measure", "none"};
  };
  std::array<Bytes, 2> file;
  std::array<std::string, 2> infoText, probeText;
  for (const std::size_t odd : {1, 0}) {
    EXPECT_RUNS(run(compress(odd == 1)));
    file[odd] = bytes("x.hbv");
    infoText[odd] = run(info).out;
    probeText[odd] = run(probe).out;
  }
  ASSERT_NE(file[0], file[1]);
  ASSERT_NE(infoText[0], infoText[1]);
  ASSERT_NE(probeText[0], probeText[1]);

  const auto isOneOf = [](const auto& found, const auto& two) { return found == two[0] || found == two[1]; };
  int reads = 0;
  for (int i = 0; i < kWrites; ++i) {
    hbChildProcess writer = start(compress(i % 2 == 0));
    do {
      const hbProgramRun read = run(reads % 2 == 0 ? info : probe);
      EXPECT_RUNS(read);
      ASSERT_TRUE(isOneOf(read.out, reads % 2 == 0 ? infoText : probeText)) << read.out;
      for (int direct = 0; direct < 20; ++direct) ASSERT_TRUE(isOneOf(bytes("x.hbv"), file)) << "write " << i;
      ++reads;
    } while (writer.running());
    ASSERT_EQ(writer.wait(), 0);
    ASSERT_EQ(bytes("x.hbv"), file[i % 2 == 0 ? 1 : 0]);
  }
  EXPECT_EQ(contents().size(), 4U) << names(contents()); // no temporary file among them
}
