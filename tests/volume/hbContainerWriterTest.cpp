#include "volume/hbContainerWriter.h"

#include <csignal>
#include <limits>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbContainerReader.h"

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
constexpr hbChunkType kType{"TEST"};

hbChunkId idOf(std::uint64_t key) { return {kType, 0, 0, 0, key}; }

std::vector<std::byte> noise(std::size_t size) {
  std::vector<std::byte> bytes(size);
  std::uint32_t state = 1;
  for (std::byte& b : bytes) b = std::byte((state = state * 1664525U + 1013904223U) >> 24U);
  return bytes;
}

void writeOne(const fs::path& path, std::string_view text) {
  hbContainerWriter writer(path);
  writer.add(idOf(0), hbChunkKind::critical, hb::test::bytesOf(text), hbCodec::stored);
  writer.commit();
}

/// No file may grow beyond `bytes` while this lives: what a full disk is to a test.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limited{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
  rlimit old_{};
  void (*handler_)(int);
};

} // namespace

RC_GTEST_PROP(hbContainerWriter, EveryChunkComesBackHoweverTheFileGrew, ()) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  struct Chunk {
    hbChunkKind kind;
    std::vector<std::byte> bytes;
  };
  std::map<hbChunkId, Chunk> written;
  std::vector<hbChunkId> order;
  // Few distinct numbers and the largest ones, so that ids differ in every member and collide now and then.
  const auto small = rc::gen::element<std::uint32_t>(0, 1, 2, std::numeric_limits<std::uint32_t>::max());
  const auto key = rc::gen::element<std::uint64_t>(0, 1, kNoLimit);
  const int rounds = *rc::gen::inRange(1, 4);
  for (int round = 0; round < rounds; ++round) {
    const auto fill = [&](hbContainerWriter& writer) {
      const int count = *rc::gen::inRange(0, 6);
      for (int i = 0; i < count; ++i) {
        const hbChunkId id{*rc::gen::element(hbChunkType{"AAAA"}, hbChunkType{"a b~"}), *small, *small, *small, *key};
        const Chunk chunk{*rc::gen::element(hbChunkKind::ancillary, hbChunkKind::critical),
                          std::vector<std::byte>(std::size_t(*rc::gen::inRange(0, 300)),
                                                 std::byte(*rc::gen::arbitrary<std::uint8_t>()))};
        const auto codec = *rc::gen::element(hbCodec::stored, hbCodec::zstd, hbCodec::planesZstd);
        if (written.contains(id)) {
          RC_ASSERT_THROWS_AS(writer.add(id, chunk.kind, chunk.bytes, codec), hbError);
          continue;
        }
        writer.add(id, chunk.kind, chunk.bytes, codec);
        written[id] = chunk;
        order.push_back(id);
      }
      writer.commit();
    };
    if (round == 0) {
      hbContainerWriter writer(path);
      fill(writer);
    } else {
      hbContainerWriter writer = hbContainerWriter::appendTo(path, {"AAAA", "a b~"});
      fill(writer);
    }
  }
  const hbContainerReader reader(path, {"AAAA", "a b~"}, 4096);
  reader.verify();
  RC_ASSERT(reader.entries().size() == order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const hbChunkEntry& entry = reader.entries()[i];
    RC_ASSERT(entry.id == order[i]);
    RC_ASSERT(entry.offset % 64 == 0U);
    RC_ASSERT(entry.kind == written[entry.id].kind);
    RC_ASSERT(reader.find(order[i]) == &entry);
    RC_ASSERT(reader.read(entry) == written[entry.id].bytes);
  }
  RC_ASSERT(reader.find({"none"}) == nullptr);
}

TEST(hbContainerWriter, TheSameChunksGiveTheSameBytes) {
  const hbTestFolder folder;
  for (const char* name : {"a.hbv", "b.hbv"}) {
    hbContainerWriter writer(folder / name);
    writer.add(idOf(1), hbChunkKind::critical, std::vector<std::byte>(100000), hbCodec::zstd);
    writer.add(idOf(0), hbChunkKind::ancillary, noise(1000), hbCodec::planesZstd);
    writer.commit();
  }
  EXPECT_EQ(hb::test::readFile(folder / "a.hbv"), hb::test::readFile(folder / "b.hbv"));

  // A file that grew has the bytes of one written at once.
  {
    hbContainerWriter writer(folder / "c.hbv");
    writer.add(idOf(1), hbChunkKind::critical, std::vector<std::byte>(100000), hbCodec::zstd);
    writer.commit();
  }
  hbContainerWriter writer = hbContainerWriter::appendTo(folder / "c.hbv", {kType});
  writer.add(idOf(0), hbChunkKind::ancillary, noise(1000), hbCodec::planesZstd);
  writer.commit();
  EXPECT_EQ(hb::test::readFile(folder / "a.hbv"), hb::test::readFile(folder / "c.hbv"));
}

TEST(hbContainerWriter, StoresWhatDoesNotShrink) {
  const hbTestFolder folder;
  hbContainerWriter writer(folder / "a.hbv");
  writer.add(idOf(0), hbChunkKind::critical, noise(500), hbCodec::zstd);
  writer.add(idOf(1), hbChunkKind::critical, std::vector<std::byte>(500), hbCodec::zstd);
  EXPECT_EQ(writer.entries()[0].codec, hbCodec::stored);
  EXPECT_EQ(writer.entries()[0].storedSize, 500U);
  EXPECT_EQ(writer.entries()[1].codec, hbCodec::zstd);
  EXPECT_LT(writer.entries()[1].storedSize, 100U);
}

TEST(hbContainerWriter, RefusesAnIdTwiceAndTypesThatAreNotText) {
  const hbTestFolder folder;
  hbContainerWriter writer(folder / "a.hbv");
  writer.add(idOf(5), hbChunkKind::critical, {}, hbCodec::stored);
  EXPECT_HB_ERROR(writer.add(idOf(5), hbChunkKind::ancillary, {}, hbCodec::zstd),
                  "chunk TEST (dataset 0, step 0, component 0, key 5): expected once, found twice");
  EXPECT_HB_ERROR(writer.add({"A\nBC"}, hbChunkKind::ancillary, {}, hbCodec::zstd), "four printable ASCII characters");
  writer.commit();
  EXPECT_EQ(hbContainerReader(folder / "a.hbv", {kType}, kNoLimit).entries().size(), 1U);
}

TEST(hbContainerWriter, AnAbandonedFileLeavesWhatWasThere) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  {
    hbContainerWriter writer(path);
    writer.add(idOf(0), hbChunkKind::critical, noise(100), hbCodec::stored);
  }
  EXPECT_EQ(folder.files(), 0);
  writeOne(path, "old");
  const auto old = hb::test::readFile(path);
  {
    hbContainerWriter writer(path);
    writer.add(idOf(0), hbChunkKind::critical, noise(100), hbCodec::stored);
  }
  {
    hbContainerWriter writer = hbContainerWriter::appendTo(path, {kType});
    writer.add(idOf(1), hbChunkKind::critical, noise(100), hbCodec::stored);
  }
  EXPECT_EQ(hb::test::readFile(path), old);
  EXPECT_EQ(folder.files(), 1);
}

TEST(hbContainerWriter, AProcessThatDiesWhileAppendingLeavesWhatWasThere) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  writeOne(path, "old");
  const auto old = hb::test::readFile(path);
  const pid_t child = ::fork();
  if (child == 0) {
    hbContainerWriter writer = hbContainerWriter::appendTo(path, {kType});
    writer.add(idOf(1), hbChunkKind::critical, noise(100000), hbCodec::stored);
    ::_exit(3); // no destructor runs
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  ASSERT_EQ(WEXITSTATUS(status), 3);
  EXPECT_EQ(hb::test::readFile(path), old);
  EXPECT_NO_THROW(hbContainerReader(path, {kType}, kNoLimit).verify());
}

TEST(hbContainerWriter, AppendingRefusesADamagedOrUnknownFile) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  EXPECT_HB_ERROR(hbContainerWriter::appendTo(path, {kType}), "a.hbv: cannot be read: No such file or directory");
  writeOne(path, "old");
  EXPECT_HB_ERROR(hbContainerWriter::appendTo(path, {"ELSE"}), "of a type unknown here");
  auto bytes = hb::test::readFile(path);
  bytes[64] ^= std::byte{1};
  hb::test::writeFile(path, bytes);
  EXPECT_HB_ERROR(hbContainerWriter::appendTo(path, {kType}), "key 0): expected checksum");
  EXPECT_EQ(hb::test::readFile(path), bytes);
  EXPECT_EQ(folder.files(), 1);
}

TEST(hbContainerWriter, AppendingCanBeCancelled) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  writeOne(path, "old");
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hbContainerWriter::appendTo(path, {kType}, progress), hbCancelled);
  EXPECT_EQ(folder.files(), 1);
}

TEST(hbContainerWriter, AFullDiskIsOneErrorAndLeavesNothing) {
  const hbTestFolder folder;
  const fs::path path = folder / "a.hbv";
  writeOne(path, "old");
  const auto old = hb::test::readFile(path);
  const auto big = noise(200000);
  const std::string expected = path.string() + ": cannot be written: File too large";
  std::string atAdd, later, atCommit, atAppend;
  std::ptrdiff_t filesAfterFailure = 0;
  {
    const FileSizeLimit limit(100000); // nothing is printed meanwhile: the test's own output may be a file
    hbContainerWriter writer(path);
    atAdd = hb::test::errorOf([&] { writer.add(idOf(0), hbChunkKind::critical, big, hbCodec::stored); });
    filesAfterFailure = folder.files();
    later = hb::test::errorOf([&] { writer.commit(); });

    // Room for header and chunk (64 + 99904 = 99968 bytes), but not for the table behind it.
    hbContainerWriter full(path);
    full.add(idOf(0), hbChunkKind::critical, std::span(big).first(99904), hbCodec::stored);
    atCommit = hb::test::errorOf([&] { full.commit(); });

    hbContainerWriter append = hbContainerWriter::appendTo(path, {kType});
    atAppend = hb::test::errorOf([&] { append.add(idOf(1), hbChunkKind::critical, big, hbCodec::stored); });
  }
  EXPECT_EQ(atAdd, expected);
  EXPECT_EQ(filesAfterFailure, 1);
  EXPECT_NE(later.find("found one committed or failed"), std::string::npos) << later;
  EXPECT_EQ(atCommit, expected);
  EXPECT_EQ(atAppend, expected);
  EXPECT_EQ(folder.files(), 1);
  EXPECT_EQ(hb::test::readFile(path), old);
}

TEST(hbContainerWriter, RefusesTargetsThatCannotBeWritten) {
  const hbTestFolder folder;
  EXPECT_HB_ERROR(hbContainerWriter(folder / "missing/a.hbv"), "a.hbv: cannot be written: No such file or directory");
  EXPECT_HB_ERROR(hbContainerWriter(folder.path()), "expected a regular file to write, found a folder");
}

TEST(hbContainerWriter, RefusesAFolderThatIsReadOnly) {
  const hbTestFolder folder;
  const fs::path locked = folder / "locked";
  fs::create_directory(locked);
  fs::permissions(locked,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  fs::permissions(folder.path(), fs::perms::others_read | fs::perms::others_exec, fs::perm_options::add);
  // Permissions do not stop root: be nobody meanwhile.
  const bool root = ::geteuid() == 0;
  ASSERT_TRUE(!root || ::seteuid(65534) == 0);
  const std::string found = hb::test::errorOf([&] { hbContainerWriter writer(locked / "a.hbv"); });
  ASSERT_TRUE(!root || ::seteuid(0) == 0);
  EXPECT_EQ(found, (locked / "a.hbv").string() + ": cannot be written: Permission denied");
}

TEST(hbContainerWriter, NothingFollowsACommit) {
  const hbTestFolder folder;
  hbContainerWriter writer(folder / "a.hbv");
  writer.commit();
  EXPECT_HB_ERROR(writer.commit(), "found one committed or failed");
  EXPECT_HB_ERROR(writer.add(idOf(0), hbChunkKind::critical, {}, hbCodec::stored), "found one committed or failed");
  EXPECT_EQ(fs::file_size(folder / "a.hbv"), 64U); // an empty container: the header alone
  EXPECT_NO_THROW(hbContainerReader(folder / "a.hbv", {}, 0).verify());
}
