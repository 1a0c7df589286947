#include "report/hbHtmlWriter.h"

#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "report/hbDataUri.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

std::string escaped(std::string_view text) {
  hbHtmlWriter page;
  page.text(text);
  return page.html();
}

TEST(hbHtmlWriter, escapesWhatHasAMeaning) {
  hbHtmlWriter page;
  page.open("a", {{"title", "<\"&'>"}});
  page.text("<\"&'> \xc3\x84 \xe2\x82\xac \xf0\x9f\x98\x80");
  page.empty("br");
  page.close();
  EXPECT_EQ(page.html(),
            "<a title=\"&lt;&quot;&amp;'&gt;\">&lt;&quot;&amp;'&gt; \xc3\x84 \xe2\x82\xac \xf0\x9f\x98\x80<br/></a>\n");
}

TEST(hbHtmlWriter, replacesWhatCannotStandInXml) {
  const std::string u = "\xef\xbf\xbd";
  EXPECT_EQ(escaped("a\x01\x1fz\t\n"), "a" + u + u + "z\t\n");
  EXPECT_EQ(escaped("\xff\xc3"), u + u);                 // no UTF-8, and cut short
  EXPECT_EQ(escaped("\xc0\xaf"), u + u);                 // overlong "/"
  EXPECT_EQ(escaped("\xed\xa0\x80"), u + u + u);         // a surrogate
  EXPECT_EQ(escaped("\xf4\x90\x80\x80"), u + u + u + u); // beyond U+10FFFF
  EXPECT_EQ(escaped("\xef\xbf\xbf"), u);                 // U+FFFF
  EXPECT_EQ(escaped("\xe0\x80\xaf\xf0\x80\x80\xaf"), u + u + u + u + u + u + u);
}

TEST(hbHtmlWriter, figuresAndNamesSayWhereTheyStand) {
  const hbReportPlace::Json report{{"a/b", {{"x", 0.0123456}, {"name", "<n>"}, {"none", nullptr}}}};
  const hbReportPlace place(report);
  hbHtmlWriter page;
  page.figure(place["a/b"]["x"], {"ms", 1e-3});
  page.quote(place["a/b"]["name"]);
  page.figure(place["a/b"]["none"]);
  page.quote(place["a/b"]["missing"]["further"]);
  EXPECT_EQ(page.html(), "<data value=\"0.0123456\" data-json=\"/a~1b/x\" data-unit=\"ms\">12.3</data>"
                         "<span data-json=\"/a~1b/name\">&lt;n&gt;</span>\xe2\x80\x93\xe2\x80\x93");
}

TEST(hbHtmlWriter, figuresHaveThreeToFourDigits) {
  EXPECT_EQ(hb::figureText(0), "0");
  EXPECT_EQ(hb::figureText(7109137), "7109137");
  EXPECT_EQ(hb::figureText(-3), "-3");
  EXPECT_EQ(hb::figureText(12345.678), "12346");
  EXPECT_EQ(hb::figureText(510.04), "510");
  EXPECT_EQ(hb::figureText(99.96), "100");
  EXPECT_EQ(hb::figureText(99.94), "99.9");
  EXPECT_EQ(hb::figureText(9.996), "10.0");
  EXPECT_EQ(hb::figureText(-1.2345), "-1.23");
  EXPECT_EQ(hb::figureText(0.9996), "1.00");
  EXPECT_EQ(hb::figureText(0.012345), "0.0123");
  EXPECT_EQ(hb::figureText(0.00012345), "1.23e-04");
  EXPECT_EQ(hb::figureText(1.2345e12), "1.23e+12");
}

TEST(hbHtmlWriter, whatIsNotFiniteIsADash) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {kInfinity, -kInfinity, kNan}) {
    EXPECT_EQ(hb::figureText(value), "\xe2\x80\x93") << value;
    const hbReportPlace::Json report{{"x", value}};
    hbHtmlWriter page;
    page.figure(hbReportPlace(report)["x"], {"", 1.0, 4});
    EXPECT_EQ(page.html(), "\xe2\x80\x93") << value;
  }
}

TEST(hbHtmlWriter, fixedDecimalsLeaveThreeDigits) {
  for (const auto& [value, text] : {std::pair(0.98765, "0.9877"), std::pair(0.01, "0.0100"), std::pair(-0.5, "-0.5000"),
                                    std::pair(0.003931131, "0.00393"), std::pair(0.0, "0")}) {
    const hbReportPlace::Json report{{"x", value}};
    hbHtmlWriter page;
    page.figure(hbReportPlace(report)["x"], {"", 1.0, 4});
    EXPECT_NE(page.html().find(std::string(">") + text + "<"), std::string::npos) << page.html();
  }
}

TEST(hbDataUri, codesAsRfc4648) {
  const std::pair<const char*, const char*> pairs[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"},
                                                       {"\xfb\xff", "+/8="}};
  for (const auto& [bytes, text] : pairs) EXPECT_EQ(hb::base64(bytes), text);
}

TEST(hbDataUri, readsAFile) {
  const hbTestFolder folder;
  std::ofstream(folder / "a") << "foo";
  EXPECT_EQ(hb::dataUri(folder / "a", "image/png"), "data:image/png;base64,Zm9v");
  EXPECT_THROW(hb::dataUri(folder / "b", "image/png"), hbError);
}

} // namespace
