#include "volume/hbInstructionSet.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "volume/hbError.h"

TEST(hbInstructionSet, EachOfThemCanBeChosen) {
  const std::vector<std::string> names = hb::instructionSets();
  ASSERT_FALSE(names.empty());
  EXPECT_EQ(hb::instructionSet(), names.front());
  for (const std::string& name : names) {
    hb::useInstructionSet(name);
    EXPECT_EQ(hb::instructionSet(), name);
    EXPECT_EQ(hb::instructionSets(), names); // the choice does not hide the others
  }
  hb::useInstructionSet("");
  EXPECT_EQ(hb::instructionSet(), names.front());
}

TEST(hbInstructionSet, AnUnknownOneChangesNothing) {
  const std::string last = hb::instructionSets().back();
  hb::useInstructionSet(last);
  EXPECT_THROW(hb::useInstructionSet("MMX"), hbError);
  EXPECT_EQ(hb::instructionSet(), last);
  hb::useInstructionSet("");
}
