#include "sparsegrid/hbIndexSetFile.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"
#include "tests/volume/hbTestFiles.h"

namespace {

hbIndexSet setOf(const std::string& text, const hbSize3& size = {33, 33, 33}) {
  return hbIndexSetFile::fromText(text, "set.txt").indexSet(size);
}

bool same(const hbIndexSet& a, const hbIndexSet& b) {
  return a.flat() == b.flat() &&
         std::equal(a.subspaces().begin(), a.subspaces().end(), b.subspaces().begin(), b.subspaces().end(),
                    [](const auto& s, const auto& t) { return s.levels == t.levels; });
}

} // namespace

TEST(hbIndexSetFile, AddsLevelZero) {
  EXPECT_TRUE(same(setOf("1 1 1"), hbIndexSet::regular(1, {})));
  EXPECT_TRUE(same(setOf("# a set\r\n\n 2\t1 1 # finer along x\n1 1 1\n1 2 1\n1 1 2\n"), hbIndexSet::regular(2, {})));
  // Some of it listed.
  EXPECT_TRUE(same(setOf("0 1 1\n1 1 1\n0 0 0\n"), hbIndexSet::regular(1, {})));
}

TEST(hbIndexSetFile, KnowsCoarseAxes) {
  EXPECT_EQ(setOf("1 1 0\n2 1 0").finest(), glm::ivec3(2, 1, 0));
  EXPECT_EQ(setOf("1 1 0\n2 1 0").storedValues(), 5 * 3 * 2);
  // Of one and of two samples: levels 0 and 1 are one.
  for (const char* text : {"2 1 1\n1 1 1", "2 0 0\n1 0 0", "2 0 1\n1 1 0", "1 0 0\n1 1 1\n2 1 0"}) {
    const hbIndexSet set = setOf(text, {5, 1, 2});
    EXPECT_EQ(set.storedValues(), 5 * 1 * 2) << text;
    EXPECT_EQ(set.flat(), glm::bvec3(false, true, false)) << text;
  }
  EXPECT_HB_ERROR(setOf("1 1 1\n1 2 1", {5, 1, 2}),
                  "set.txt: line 2: expected level 0 or 1 along y, which has one sample, found 2");
  EXPECT_HB_ERROR(setOf("1 1 3", {5, 1, 2}), "line 1: expected level 0 or 1 along z, which has two samples, found 3");
}

TEST(hbIndexSetFile, RefusesWhatIsNoList) {
  for (const char* text :
       {"1 1", "1 1 1 1", "1 1 x", "1 1 -1", "1 1 21", "1 1 1.0", "1,1,1", "1 1 99999999999999999999"})
    EXPECT_HB_ERROR(setOf(std::string("# levels\n") + text),
                    "set.txt: line 2: expected three levels from 0 to 20, found '" + std::string(text) + "'");
  EXPECT_HB_ERROR(setOf(std::string("1 1 \0", 5)), "found '1 1 ?'");
  for (const char* text : {"", "\n\n", "# 1 1 1"})
    EXPECT_HB_ERROR(setOf(text), "set.txt: expected a subspace a line, found none");
  EXPECT_HB_ERROR(setOf("1 1 1\n2 1 1\n\n2 1 1"),
                  "set.txt: line 4: expected each subspace once, found (2,1,1) of line 2 again");
}

TEST(hbIndexSetFile, RefusesSetsThatAreNotClosed) {
  EXPECT_HB_ERROR(setOf("1 1 1\n3 1 1"), "set.txt: line 2: expected (2,1,1), which (3,1,1) needs, found no such line");
  EXPECT_HB_ERROR(setOf("1 1 1\n2 1 1\n1 2 1\n2 2 2\n2 2 1"), "line 4: expected (1,2,2), which (2,2,2) needs");
  // Level 0 without level 1, along an axis that others refine.
  EXPECT_HB_ERROR(setOf("1 1 1\n2 1 0"), "line 2: expected (2,1,1), which (2,1,0) needs");
  std::string full;
  for (int z = 1; z <= 20; ++z)
    for (int y = 1; y <= 20; ++y)
      for (int x = 1; x <= 20; ++x)
        full += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  EXPECT_HB_ERROR(setOf(full), "set.txt: expected fewer than 2^60 values");
}

TEST(hbIndexSetFile, ReadsFilesOfABoundedSize) {
  const hbTestFolder folder;
  const auto path = folder / "set.txt";
  std::string text = "1 1 1\n2 1 1\n";
  hb::test::writeFile(path, hb::test::bytesOf(text));
  EXPECT_EQ(hbIndexSetFile::load(path).indexSet({33, 33, 33}).storedValues(), 5 * 3 * 3);
  text.resize(std::size_t{1} << 20, '\n');
  hb::test::writeFile(path, hb::test::bytesOf(text));
  EXPECT_NO_THROW(hbIndexSetFile::load(path));
  hb::test::writeFile(path, hb::test::bytesOf(text + "\n"));
  EXPECT_HB_ERROR(hbIndexSetFile::load(path), "set.txt: expected an index set of at most 1048576 bytes, found 1048577");
  EXPECT_HB_ERROR(hbIndexSetFile::load(folder / "none.txt"), "none.txt");
}

RC_GTEST_PROP(hbIndexSetFile, TextComesBackAsTheSet, ()) {
  const hbIndexSet set = *hbTestSets::any();
  RC_ASSERT(same(setOf(hbIndexSetFile::text(set), hbTestSets::sizeOf(set)), set));
}

TEST(hbIndexSetFile, TextListsWhatMustBe) {
  EXPECT_EQ(hbIndexSetFile::text(hbIndexSet::regular(2, {{2, 2, 0}, {false, false, true}})),
            "# lx ly lz\n1 1 0\n2 1 0\n1 2 0\n");
}
