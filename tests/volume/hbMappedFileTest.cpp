#include "volume/hbMappedFile.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/volume/hbTestFiles.h"

TEST(hbMappedFile, MapsTheWholeFileAndOutlivesItsName) {
  const hbTestFolder folder;
  hb::test::writeFile(folder / "a", hb::test::bytesOf("some bytes"));
  std::uint64_t size = 0;
  const auto bytes = hb::mapFile(folder / "a", size);
  std::filesystem::remove(folder / "a");
  EXPECT_EQ(size, 10U);
  EXPECT_EQ(bytes.get()[5], std::byte('b'));
}

TEST(hbMappedFile, ReleasedPagesAreReadAgain) {
  const hbTestFolder folder;
  hb::test::writeFile(folder / "a", hb::test::bytesOf("some bytes"));
  std::uint64_t size = 0;
  const auto bytes = hb::mapFile(folder / "a", size);
  // Advice goes to the mapping behind any pointer that shares it, and to nothing else.
  const std::shared_ptr<const std::byte> part(bytes, bytes.get() + 5);
  hb::adviseScatteredReads(part);
  hb::releasePages(part);
  EXPECT_EQ(part.get()[0], std::byte('b'));
  const auto own = std::make_shared<const std::byte>(std::byte{7});
  hb::releasePages(own);
  EXPECT_EQ(*own, std::byte{7});
}

namespace {

/// Bytes of this process's memory that are pages of files, on disk or in memory.
std::int64_t residentFileBytes() {
  std::ifstream status("/proc/self/status");
  std::int64_t sum = 0;
  for (std::string word; status >> word;)
    if (word == "RssFile:" || word == "RssShmem:") {
      std::int64_t kilobytes = 0;
      status >> kilobytes;
      sum += kilobytes * 1024;
    }
  return sum;
}

} // namespace

TEST(hbMappedFile, PartsOfItAreReleasedByThemselves) {
  const hbTestFolder folder;
  constexpr std::uint64_t kMega = 1 << 20, kBytes = 64 * kMega;
  hb::test::writeFile(folder / "large", hb::test::bytesOf("start"));
  std::filesystem::resize_file(folder / "large", kBytes);
  std::uint64_t size = 0;
  const auto bytes = hb::mapFile(folder / "large", size);
  const auto touchAll = [&] {
    int sum = 0;
    for (std::uint64_t i = 0; i < kBytes; i += 4096) sum += int(bytes.get()[i]);
    return sum;
  };
  EXPECT_EQ(touchAll(), int('s'));
  const std::int64_t before = residentFileBytes();
  // 2 MB on each side go with what is named. Pages of the program come and go meanwhile.
  const auto released = [&](std::int64_t least, std::int64_t most) {
    const std::int64_t bytesLess = before - residentFileBytes();
    EXPECT_GE(bytesLess, (least - 1) * std::int64_t(kMega));
    EXPECT_LE(bytesLess, (most + 1) * std::int64_t(kMega));
    EXPECT_EQ(touchAll(), int('s'));
  };
  hb::releasePages(bytes, 16 * kMega + 5, 16 * kMega);
  released(16, 22);
  hb::releasePages(std::shared_ptr<const std::byte>(bytes, bytes.get() + 16 * kMega), 0, 16 * kMega);
  released(16, 22);
  hb::releasePages(bytes, kBytes - 1, 100 * kMega); // no further than the end
  released(2, 5);
  hb::releasePages(bytes, kBytes + 10 * kMega, kMega);
  released(0, 0);
  hb::releasePages(std::make_shared<const std::byte>(), 0, 1);
}

TEST(hbMappedFile, RefusesWhatIsNoFile) {
  const hbTestFolder folder;
  std::uint64_t size = 0;
  EXPECT_HB_ERROR(hb::mapFile(folder / "missing", size), "cannot be read");
  EXPECT_HB_ERROR(hb::mapFile(folder.path(), size), "folder");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_HB_ERROR(hb::mapFile(folder / "pipe", size), "pipe"); // and does not wait for a writer
}

TEST(hbMappedFile, AnEmptyFileHasNoBytes) {
  const hbTestFolder folder;
  hb::test::writeFile(folder / "empty", {});
  std::uint64_t size = 1;
  EXPECT_NE(hb::mapFile(folder / "empty", size), nullptr);
  EXPECT_EQ(size, 0U);
}
