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
