#include "volume/fields/hbFieldParameters.h"

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

TEST(hbFieldParameters, TakesValuesOverDefaults) {
  const hbFieldParameters defaults{{"a", "1"}, {"b", "x"}};
  EXPECT_EQ(hb::fieldName("n"), "n");
  EXPECT_EQ(hb::fieldName("n,a=2"), "n");
  EXPECT_EQ(hb::parseFieldParameters("n", defaults), defaults);
  const auto given = hb::parseFieldParameters("n,b=,a=2", defaults);
  EXPECT_EQ(given, (hbFieldParameters{{"a", "2"}, {"b", ""}}));
  EXPECT_EQ(hb::fieldSpecification("n", given), "n,a=2,b=");
  for (const char* bad : {"n,c=1", "n,a", "n,=1", "n,a=1,,b=2"})
    EXPECT_HB_ERROR(hb::parseFieldParameters(bad, defaults), "field n: expected parameters among a=, b=");
}

TEST(hbFieldParameters, NumbersAreWholeAndInRange) {
  const auto number = [](const char* text) { return hb::fieldNumber({{"a", text}}, "a", 0.5, 2.0); };
  EXPECT_EQ(number("0.5"), 0.5);
  EXPECT_EQ(number("2"), 2.0);
  EXPECT_EQ(number("1e0"), 1.0);
  for (const char* bad : {"", "x", "1x", " 1", "0.49", "2.01", "nan", "inf"})
    EXPECT_HB_ERROR(number(bad), "field parameter a: expected a number from 0.5 to 2");
}
