#include "report/hbSetChoice.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

hbInput volumeOf(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  hbInput input;
  input.name = "the volume";
  input.volume =
      std::make_shared<const hbVolume>(hbVolume::fromSamples(g, std::vector<float>(std::size_t(g.samples())), 1));
  return input;
}

hbInput fieldOf(const std::string& name) { return hbInput::open("field:" + name, {}); }

hbIndexSet setFor(const hbInput& input, const glm::ivec3& levels, bool uncapped = false, bool full = false) {
  return hbSetChoice{levels, full, uncapped, {}}.indexSet(input);
}
hbIndexSet setFor(const hbInput& input, int level, bool uncapped = false, bool full = false) {
  return setFor(input, glm::ivec3(level), uncapped, full);
}

hbSetChoice listed(const char* text) {
  return {glm::ivec3(0), false, false, hbIndexSetFile::fromText(text, "set.txt")};
}

} // namespace

TEST(hbSetChoice, TakesOneLevel) {
  const hbInput volume = volumeOf({33, 10, 1});
  // No level: the one that resolves the longest axis, other axes no finer than theirs.
  EXPECT_EQ(setFor(volume, 0).finest(), glm::ivec3(5, 4, 0));
  EXPECT_EQ(setFor(volume, 0).number(), 5);
  EXPECT_EQ(setFor(volume, 3).finest(), glm::ivec3(3, 3, 0));
  EXPECT_EQ(setFor(volume, 8).finest(), glm::ivec3(5, 4, 0)); // of a level beyond, only what resolves the samples
  EXPECT_EQ(setFor(volume, 8, true).finest(), glm::ivec3(8, 8, 0));
  EXPECT_EQ(setFor(volume, 0, false, true).storedValues(), 33 * 17);
  EXPECT_EQ(setFor(volume, 2, false, true).storedValues(), 5 * 5);
  // Two samples are two nodes at any level, one sample is level 1 of nothing.
  EXPECT_EQ(setFor(volumeOf({2, 2, 2}), 4, true).storedValues(), 8);
  EXPECT_EQ(setFor(volumeOf({1, 1, 1}), 0).storedValues(), 1);
  // A field at a level is the paper's grid; without, it is looked at as its samples are.
  EXPECT_EQ(setFor(fieldOf("smooth"), 8).storedValues(), 21249);
  EXPECT_EQ(setFor(fieldOf("smooth,size=33x10x1"), 0).finest(), glm::ivec3(5, 4, 0));
  EXPECT_HB_ERROR(setFor(volume, 21), "level: expected 1 to 20, found 21");
}

TEST(hbSetChoice, TakesALevelForEachAxis) {
  const hbInput volume = volumeOf({33, 10, 5});
  EXPECT_EQ(setFor(volume, {5, 3, 1}).finest(), glm::ivec3(5, 3, 1));
  EXPECT_FALSE(setFor(volume, {5, 3, 1}).contains({2, 3, 1}));
  EXPECT_EQ(setFor(volume, {4, 3, 1}, false, true).storedValues(), 17 * 9 * 3);
  EXPECT_EQ(setFor(volume, {6, 6, 6}).finest(), glm::ivec3(5, 4, 2));
  EXPECT_EQ(setFor(volume, {6, 6, 7}, true).finest(), glm::ivec3(6, 6, 7));
  EXPECT_EQ(setFor(volumeOf({33, 2, 1}), {4, 9, 9}).finest(), glm::ivec3(4, 0, 0));
  EXPECT_EQ(setFor(fieldOf("smooth,size=9"), {4, 6, 3}).finest(), glm::ivec3(4, 6, 3));
}

TEST(hbSetChoice, TakesAList) {
  // Finer than the samples, too.
  EXPECT_EQ(listed("1 1 1\n2 1 1\n3 1 1").indexSet(volumeOf({5, 5, 1})).finest(), glm::ivec3(3, 1, 0));
  EXPECT_HB_ERROR(listed("2 1 1").indexSet(volumeOf({5, 5, 5})), "set.txt: line 1: expected (1,1,1)");
}

TEST(hbSetChoice, SizesAnalyticFieldsOnly) {
  const auto sizeFor = [](const hbSetChoice& choice, const hbInput& input) {
    return choice.inputFor(input).geometry().size;
  };
  const hbInput field = fieldOf("smooth,size=9x2x1");
  EXPECT_EQ(sizeFor({}, field), hbSize3(9, 2, 1));
  EXPECT_EQ(sizeFor({glm::ivec3(0), true, true, {}}, field), hbSize3(9, 2, 1));
  EXPECT_EQ(sizeFor({glm::ivec3(5), false, false, {}}, field), hbSize3(33, 2, 1));
  EXPECT_EQ(sizeFor({{4, 6, 3}, false, false, {}}, fieldOf("smooth")), hbSize3(17, 65, 9));
  EXPECT_EQ(sizeFor(listed("1 1 1\n2 1 1"), fieldOf("smooth")), hbSize3(5, 3, 3));
  EXPECT_EQ(sizeFor(listed("1 1 0\n2 1 0"), fieldOf("smooth")), hbSize3(5, 3, 2));
  EXPECT_EQ(sizeFor({{4, 4, 4}, false, false, {}}, volumeOf({5, 4, 3})), hbSize3(5, 4, 3));
  EXPECT_EQ(sizeFor({{20, 20, 19}, false, false, {}}, fieldOf("smooth")), hbSize3(1048577, 1048577, 524289));
  EXPECT_HB_ERROR(sizeFor({glm::ivec3(20), false, false, {}}, fieldOf("smooth")),
                  "field:smooth: expected levels whose full grid has fewer than 2^60 samples, found 20,20,20");
  EXPECT_HB_ERROR(sizeFor({glm::ivec3(20), true, false, {}}, fieldOf("smooth")), "2^60");
}
