#include "report/hbComparisonFolder.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

using Json = hbComparisonFolder::Json;
namespace fs = std::filesystem;

std::string errorOf(const fs::path& path, const Json& settings, bool restart = false) {
  try {
    hbComparisonFolder(path, settings, restart);
  } catch (const hbError& error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(hbComparisonFolder, RemembersRecordsAndTheirSitting) {
  const hbTestFolder folder;
  const fs::path path = folder / "new" / "deep";
  const Json settings{{"levels", {5, 6}}};
  {
    hbComparisonFolder first(path, settings, false);
    EXPECT_EQ(first.runs(), 0);
    EXPECT_FALSE(first.find("a"));
    first.keep("a", {{"x", 1}});
    EXPECT_EQ(first.runs(), 1);
    EXPECT_EQ(first.find("a"), (Json{{"x", 1}, {"run", 1}}));
  }
  hbComparisonFolder second(path, settings, false);
  EXPECT_EQ(second.runs(), 1); // nothing was measured yet
  second.keep("b", {{"x", 2}});
  second.keep("c", {{"x", 3}});
  EXPECT_EQ(second.runs(), 2);
  EXPECT_EQ(second.find("a"), (Json{{"x", 1}, {"run", 1}}));
  EXPECT_EQ(second.find("c"), (Json{{"x", 3}, {"run", 2}}));
}

TEST(hbComparisonFolder, RefusesOtherComparisonsAndOtherFiles) {
  const hbTestFolder folder;
  const fs::path path = folder / "c";
  const Json settings{{"levels", {5, 6}}, {"width", 8}}, other{{"levels", {5, 6}}, {"width", 9}};
  hbComparisonFolder(path, settings, false).keep("a", {{"x", 1}});
  EXPECT_NE(errorOf(path, other).find("width 8, found 9"), std::string::npos) << errorOf(path, other);
  EXPECT_TRUE(hbComparisonFolder(path, settings, false).find("a"));

  EXPECT_NE(errorOf(path, {{"levels", {5, 6}}}).find("width 8, found none"), std::string::npos);

  // Begun anew, nothing of the old one is left.
  hbComparisonFolder again(path, other, true);
  EXPECT_FALSE(again.find("a"));
  EXPECT_EQ(again.runs(), 0);

  const fs::path full = folder / "full";
  fs::create_directories(full);
  std::ofstream(full / "thesis.txt") << "mine";
  for (const bool restart : {false, true})
    EXPECT_NE(errorOf(full, settings, restart).find("other files"), std::string::npos);
  EXPECT_TRUE(fs::exists(full / "thesis.txt"));
  EXPECT_NE(errorOf(full / "thesis.txt", settings).find("found a file"), std::string::npos);
}

TEST(hbComparisonFolder, LeavesWhatIsNotItsOwn) {
  const hbTestFolder folder;
  const fs::path path = folder / "d";
  fs::create_directories(path / "pictures");
  std::ofstream(path / "pictures" / "family.png") << "mine";
  std::ofstream(path / "comparison.json") << R"({"mine": 1, "settings": {}})";
  for (const bool restart : {false, true})
    EXPECT_NE(errorOf(path, Json{{"width", 8}}, restart).find("other files"), std::string::npos);
  EXPECT_TRUE(fs::exists(path / "pictures" / "family.png"));
}

TEST(hbComparisonFolder, IsForOneAtATime) {
  const hbTestFolder folder;
  const Json settings{{"width", 8}};
  {
    const hbComparisonFolder first(folder / "c", settings, false);
    EXPECT_NE(errorOf(folder / "c", settings).find("another process is at work"), std::string::npos);
  }
  EXPECT_EQ(errorOf(folder / "c", settings), "");
}

TEST(hbComparisonFolder, ARecordWithoutItsFilesIsNone) {
  const hbTestFolder folder;
  hbComparisonFolder comparison(folder / "c", Json{{"width", 8}}, false);
  comparison.keep("a", {{"image", "pictures/a.png"}, {"difference", nullptr}});
  EXPECT_FALSE(comparison.find("a"));
  std::ofstream(folder / "c" / "pictures" / "a.png") << "x";
  EXPECT_TRUE(comparison.find("a"));
}

TEST(hbComparisonFolder, NamesNeedNotBeUtf8) {
  const hbTestFolder folder;
  const Json settings{{"input", "a\xff.nrrd"}};
  hbComparisonFolder(folder / "c", settings, false).keep("a", {{"error", "\xff"}});
  EXPECT_EQ(errorOf(folder / "c", settings), "");
  EXPECT_NE(errorOf(folder / "c", {{"input", "b\xff"}}).find("expected input"), std::string::npos);
}

TEST(hbComparisonFolder, TakesADamagedRecordForNone) {
  const hbTestFolder folder;
  hbComparisonFolder comparison(folder / "c", Json{{"width", 8}}, false);
  std::ofstream(folder / "c" / "records" / "a.json") << "{\"x\": ";
  EXPECT_FALSE(comparison.find("a"));
}
