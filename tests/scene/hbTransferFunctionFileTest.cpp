#include "scene/hbTransferFunctionFile.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "scene/hbColorSpace.h"
#include "volume/hbError.h"

namespace {

using ColorSpace = hbTransferFunction::ColorSpace;
using Definition = hbTransferFunction::Definition;

std::vector<hbTransferFunction> everything() {
  std::vector<hbTransferFunction> functions;
  for (const std::string_view name : hbTransferFunction::presetNames())
    functions.push_back(hbTransferFunction::preset(name));
  functions.emplace_back(Definition{.name = "all of \"it\" \xc3\xa4",
                                    .colorSpace = ColorSpace::hsv,
                                    .hsvWrap = true,
                                    .colors = {{-1.0 / 3.0, {0.1, 0.2, 0.3}}, {0.5, {1, 0, 0}}, {0.5, {0, 0, 1}}},
                                    .opacities = {{-1e-7, 0.25, 0.125, 1.0 / 7.0}, {3e38, 1.0 / 3.0, 1, 1}},
                                    .belowColor = glm::dvec3(0.1),
                                    .aboveColor = glm::dvec3(0.7),
                                    .nanColor = {0.3, 0.2, 0.1},
                                    .nanOpacity = 0.9,
                                    .outside = hbTransferFunction::Outside::zero,
                                    .unitLength = 0.1,
                                    .relative = true});
  return functions;
}

std::string errorOf(const std::string& text, const std::string& only = "") {
  try {
    hb::transferFunctionsFromJson(text, "m.json", only);
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

std::string tableErrorOf(const std::string& text) {
  try {
    hb::transferFunctionFromTable(text, "t.txt");
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

std::filesystem::path temporary(const char* name) { return std::filesystem::path(testing::TempDir()) / name; }

// As ParaView 5 exports a map with opacities.
const char* const kExported = R"([
	{
		"ColorSpace" : "Diverging",
		"Creator" : "somebody",
		"DefaultMap" : true,
		"Name" : "Mine",
		"NanColor" : [ 1, 1, 0 ],
		"NanOpacity" : 1,
		"Points" : [ 0, 0, 0.5, 0, 1000, 0.75, 0.5, 0 ],
		"RGBPoints" : [ 0, 0.23137254902, 0.298039215686, 0.752941176471, 1000, 0.705882352941, 0.0156862745098, 0.149019607843 ]
	}
])";

} // namespace

TEST(hbTransferFunctionFile, JsonRoundTripsExactly) {
  const auto functions = everything();
  const std::string text = hb::toJson(functions);
  const auto again = hb::transferFunctionsFromJson(text, "m.json");
  ASSERT_EQ(again.size(), functions.size());
  for (std::size_t i = 0; i < functions.size(); ++i) EXPECT_EQ(again[i], functions[i]) << functions[i].name();
  EXPECT_EQ(hb::toJson(again), text);
}

RC_GTEST_PROP(hbTransferFunctionFile, AnyNumbersRoundTrip, ()) {
  // Any 64 bits of a fraction, and any value that is one of a float.
  const auto fraction = [] { return double(*rc::gen::arbitrary<std::uint64_t>()) * 0x1p-64; };
  const double lo = *rc::gen::arbitrary<float>(), hi = *rc::gen::arbitrary<float>();
  RC_PRE(std::isfinite(lo) && std::isfinite(hi) && lo < hi);
  const hbTransferFunction f({.colors = {{lo, {fraction(), fraction(), fraction()}}, {hi, glm::dvec3(fraction())}},
                              .opacities = {{lo, fraction(), fraction(), fraction()}}});
  const auto again = hb::transferFunctionsFromJson(hb::toJson(std::vector{f}), "m.json");
  RC_ASSERT(again.size() == 1U && again[0] == f);
}

TEST(hbTransferFunctionFile, ReadsWhatParaViewExports) {
  const auto functions = hb::transferFunctionsFromJson(kExported, "m.json");
  ASSERT_EQ(functions.size(), 1U);
  const hbTransferFunction& f = functions[0];
  EXPECT_EQ(f.name(), "Mine");
  EXPECT_EQ(f.range(), std::pair(0.0, 1000.0));
  EXPECT_EQ(f.opacity(500), 0.375);
  EXPECT_EQ(f.definition().colorSpace, ColorSpace::diverging);
  EXPECT_EQ(f.definition().nanColor, glm::dvec3(1, 1, 0));
  EXPECT_EQ(f.definition().nanOpacity, 1.0);
  // Moreland's white, (221, 221, 221) up to its rounding and the digits of matrices.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(255 * hb::linearToSrgb(f.colour(500)[c]), 221, 1.0);
}

TEST(hbTransferFunctionFile, ReadsOneObjectAndDefaults) {
  const auto functions = hb::transferFunctionsFromJson(
      R"({"ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 2, 1, 1, 1], "UseBelowRangeColor": 1, "UseAboveRangeColor": true,
          "BelowRangeColor": [1, 0, 0], "UseLogScale": 0})",
      "m.json");
  ASSERT_EQ(functions.size(), 1U);
  EXPECT_EQ(functions[0].opacity(0.5), 0.25);
  EXPECT_EQ(functions[0].definition().belowColor, glm::dvec3(1, 0, 0));
  EXPECT_EQ(functions[0].definition().aboveColor, glm::dvec3(0.5));
  EXPECT_EQ(functions[0].opacity(std::numeric_limits<double>::quiet_NaN()), 0.0);
}

TEST(hbTransferFunctionFile, OneOfManyByName) {
  const std::string text = R"([{"Name": "a", "IndexedColors": [0, 0, 0]},
      {"Name": "b", "ColorSpace": "Step", "RGBPoints": [0, 0, 0, 0, 2, 1, 1, 1]}])";
  EXPECT_EQ(hb::transferFunctionsFromJson(text, "m.json", "b").size(), 1U);
  EXPECT_EQ(errorOf(text), "m.json: map 1 'a': IndexedColors: expected colours over values, found a map of categories");
  EXPECT_EQ(errorOf(text, "c"), "m.json: expected a colour map 'c', found none among 2");
}

TEST(hbTransferFunctionFile, ErrorsNameTheMapAndTheKey) {
  const auto map = [](const std::string& members) {
    return R"([{"Name": "x", "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1])" + members + "}]";
  };
  const std::vector<std::pair<std::string, std::string>> cases{
      {"7", "m.json: expected an array of colour maps, found 7"},
      {"[]", "m.json: expected a colour map, found none"},
      {"[1]", "m.json: map 1 '': expected an object, found 1"},
      {"[{}]", "m.json: map 1 '': ColorSpace: expected, but missing"},
      {R"([{"ColorSpace": "RGB"}])", "m.json: map 1 '': RGBPoints: expected, but missing"},
      {R"([{"ColorSpace": "Lab/CIEDE2000"}])",
       "m.json: map 1 '': ColorSpace: expected RGB or HSV or Lab or Diverging or Step, found \"Lab/CIEDE2000\""},
      {R"([{"ColorSpace": "RGB", "RGBPoints": [0, 0, 0]}])",
       "m.json: map 1 '': RGBPoints: expected an array of four numbers a point, found 3"},
      {map(R"(, "Points": [0, 0, 0.5, 0, 1, "a", 0.5, 0])"),
       "m.json: map 1 'x': Points: expected a number, found \"a\""},
      {map(R"(, "Points": {})"),
       "m.json: map 1 'x': Points: expected an array of four numbers a point, found an object"},
      {map(R"(, "UseLogScale": 1)"),
       "m.json: map 1 'x': UseLogScale: expected a linear scale, found a logarithmic one"},
      {map(R"(, "HSVWrap": 2)"), "m.json: map 1 'x': HSVWrap: expected 0 or 1, found 2"},
      {map(R"(, "NanOpacity": -1)"), "m.json: map 1 'x': NanOpacity: expected a number in [0,1], found -1"},
      {map(R"(, "NanColor": [1, 2])"), "m.json: map 1 'x': NanColor: expected an array of 3 numbers, found an array"},
      {map(R"(, "OpacityOutside": "wrap")"),
       "m.json: map 1 'x': OpacityOutside: expected clamp or zero, found \"wrap\""},
      {map(R"(, "ScalarOpacityUnitDistance": 0)"),
       "m.json: map 1 'x': ScalarOpacityUnitDistance: expected a length from 1e-80 to 1e80, found 0"},
      {map(R"(, "Points": [0, 0, 0.5, 0, -1, 1, 0.5, 0])"),
       "m.json: map 1 'x': Points: point 2: expected a value of at least 0, that of the point before, found -1"},
      {"[{},",
       "m.json: line 1, column 5: syntax error while parsing value - unexpected end of input; expected '[', '{', "
       "or a literal"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(errorOf(text), message) << text;
}

TEST(hbTransferFunctionFile, ReadsTables) {
  const auto f =
      hb::transferFunctionFromTable("# value r g b opacity\n-10 0 0 0 0\n\n 5\t1 0.5 0 0.25 # half\r\n20 1 1 1 1", "t");
  EXPECT_EQ(f.range(), std::pair(-10.0, 20.0));
  EXPECT_EQ(f.colour(5), hb::srgbToLinear(glm::dvec3(1, 0.5, 0)));
  EXPECT_EQ(f.opacity(12.5), 0.625);
  EXPECT_EQ(tableErrorOf("0 0 0 0 0\n1 1 1 1\n"),
            "t.txt: line 2: expected value, red, green, blue and opacity, found 4 columns");
  EXPECT_EQ(tableErrorOf("# none\n0 0 0 x 0"), "t.txt: line 2: expected a number in [0,1], found x");
  EXPECT_EQ(tableErrorOf("0 0 255 0 0"), "t.txt: line 1: expected a number in [0,1], found 255");
  EXPECT_EQ(tableErrorOf("a 0 0 0 0"), "t.txt: line 1: expected a number, found a");
  EXPECT_EQ(tableErrorOf(""), "t.txt: RGBPoints: expected at least one point, found none");
}

TEST(hbTransferFunctionFile, SavesAndLoadsEitherKind) {
  const auto path = temporary("hbTransferFunctionFileTest.json"), table = temporary("hbTransferFunctionFileTest.txt");
  const auto functions = everything();
  hb::saveTransferFunctions(functions, path);
  EXPECT_EQ(hb::loadTransferFunctions(path), functions);
  EXPECT_EQ(hb::loadTransferFunctions(path, "fire"), std::vector{hbTransferFunction::preset("fire")});
  std::ofstream(table) << "0 0 0 0 0\n1 1 1 1 1\n";
  EXPECT_EQ(hb::loadTransferFunctions(table).size(), 1U);
  EXPECT_THROW(hb::loadTransferFunctions(temporary("hbTransferFunctionFileTest-missing.json")), hbError);
  std::ofstream(table) << std::string((1 << 20) + 1, ' ');
  EXPECT_THROW(hb::loadTransferFunctions(table), hbError);
}

TEST(hbTransferFunctionFile, TheLargestFunctionFitsAFile) {
  Definition d{.name = std::string(hbTransferFunction::kMaxNameLength, '\x01')};
  for (std::size_t i = 0; i < hbTransferFunction::kMaxPoints; ++i) {
    // Negative, of 17 digits and a three-digit exponent: as long as a number gets.
    const double value = -1.2345678901234567e-101 * double(hbTransferFunction::kMaxPoints - i);
    d.colors.push_back({value, glm::dvec3(1.2345678901234567e-101)});
    d.opacities.push_back({value, 1.2345678901234567e-101, 1.2345678901234567e-101, 1.2345678901234567e-101});
  }
  d.opacities.push_back({1.0, 1.0});
  d.opacities.erase(d.opacities.begin());
  const hbTransferFunction f(std::move(d));
  const auto path = temporary("hbTransferFunctionFileTest-large.json");
  hb::saveTransferFunctions(std::vector{f}, path);
  EXPECT_EQ(hb::loadTransferFunctions(path), std::vector{f});
  EXPECT_THROW(hb::saveTransferFunctions(std::vector{f, f}, path), hbError);
  EXPECT_EQ(hb::loadTransferFunctions(path), std::vector{f}); // what was there stays
}
