#include "report/hbFolderLock.h"

#include <fstream>
#include <optional>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

TEST(hbFolderLock, IsForOneAtATime) {
  const hbTestFolder folder;
  std::optional<hbFolderLock> first(std::in_place, folder.path());
  EXPECT_THROW(hbFolderLock(folder.path()), hbError);
  EXPECT_THROW(hbFolderLock(folder.path()), hbError);
  first.reset();
  EXPECT_NO_THROW(hbFolderLock(folder.path()));
}

TEST(hbFolderLock, RefusesWhatIsNoFolder) {
  const hbTestFolder folder;
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(hbFolderLock(folder / "file"), hbError);
  EXPECT_THROW(hbFolderLock(folder / "none"), hbError);
}
