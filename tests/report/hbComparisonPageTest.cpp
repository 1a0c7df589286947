#include "report/hbComparisonPage.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/hbComparisonPagePictures.h"
#include "report/hbComparisonPageTables.h"
#include "report/hbComparisonPlots.h"
#include "report/hbExternalProgram.h"
#include "tests/report/hbTestReport.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

/// A report's page in a folder of its own, with its pictures and, if asked for, its plots.
class hbComparisonPageTest : public ::testing::Test {
protected:
  void write(Json report, bool plots = false) {
    hb::test::writePictures(report, folder_.path());
    if (plots) hb::makeComparisonPlots(report, folder_.path());
    save("report.json", report.dump(1));
    hb::writeComparisonPage(report, folder_.path());
  }

  void save(const std::string& name, std::string_view text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  std::string page() const {
    std::ifstream file(folder_ / "index.html", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  /// What checkPage.py finds; nothing for a good page.
  std::string findings() const {
    const auto python = hbExternalProgram::find("python3").value();
    const auto result =
        python.run({HBVOL_CHECK_PAGE, (folder_ / "index.html").string(), (folder_ / "report.json").string()});
    EXPECT_EQ(result.status == 0, result.output.empty());
    EXPECT_EQ(result.errors, "");
    return result.output;
  }

  hbTestFolder folder_;
};

TEST_F(hbComparisonPageTest, isWellFormedAndEveryFigureIsInTheReport) {
  write(hb::test::report(), true);
  EXPECT_EQ(findings(), "");
  EXPECT_EQ(page().find("plots are missing"), std::string::npos);
}

/// Replaces the text's first `what`, which must be there.
void replaceFirst(std::string& text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  ASSERT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), by);
}

TEST_F(hbComparisonPageTest, theCheckFindsWhatIsWrong) {
  Json report = hb::test::report();
  write(report);
  report["cases"].push_back(report["cases"][0]); // a case that is not on the page
  save("report.json", report.dump());
  std::string changed = page();
  const std::string frame = "data-unit=\"ms\">12.3</data>"; // there is one after the other
  replaceFirst(changed, frame, "data-unit=\"ms\">12.5</data>");
  replaceFirst(changed, frame, "data-unit=\"ms\">12</data>");
  replaceFirst(changed, frame, "data-unit=\"h\">12.3</data>");
  replaceFirst(changed, "<nav>", "<p>12.3 ms</p><nav>");
  replaceFirst(changed, "</nav>", "<a href=\"http://example.org\">a</a><script></script></nav> tail 7 ");
  replaceFirst(changed, "<data value=\"7109137\"", "<data value=\"7109138\"");
  replaceFirst(changed, "/input/range/1", "/input/range/2");
  replaceFirst(changed, ">sparse grid, level 6</span>", ">sparse grid, level 7</span>");
  replaceFirst(changed, "src=\"data:", "src=\"https://example.org/");
  replaceFirst(changed, "src=\"data:", "src=\"pictures/a.png\" title=\"");
  replaceFirst(changed, "body {", "body { background: url(a.png);");
  replaceFirst(changed, "id=\"failed\"", "id=\"columns\"");
  save("index.html", changed);
  const std::string found = findings();
  for (const char* words :
       {"\"12.5\" does not round", "\"12\" shows too few digits", "no figure in a known unit",
        "\"12.3 ms\" has a figure that does not say", "\"tail 7\" has a figure", "example.org\" leads out",
        "<script>: is not allowed", "a value that is not the report's", "/input/range/2: is not in the report",
        "\"sparse grid, level 7\" is not the report's text", "src=\"https://example.org/",
        "src=\"pictures/a.png\" is not", "its style loads something", "an id is used twice",
        "href=\"#failed\" leads out", "/cases/18/seconds_frame/median: is missing"})
    EXPECT_NE(found.find(words), std::string::npos) << words << " in:\n" << found;

  replaceFirst(changed, "</nav>", "</p>");
  save("index.html", changed);
  EXPECT_NE(findings().find("not well-formed"), std::string::npos);
}

TEST_F(hbComparisonPageTest, namesAreEscaped) {
  Json report = hb::test::report();
  report["choices"][1]["label"] = "<script>&amp;\"'\x01 \xe2\x82\xac";
  write(report);
  EXPECT_EQ(findings(), "");
  EXPECT_EQ(page().find("<script>"), std::string::npos);
}

TEST_F(hbComparisonPageTest, failuresAreListedWithTheirErrors) {
  Json report = hb::test::report();
  Json& one = report["cases"][1];
  one["status"] = "failed";
  one["error"] = "opengl: expected 1 GB, found 2 GB";
  write(report);
  EXPECT_EQ(findings(), "");
  EXPECT_NE(page().find("data-json=\"/choices/5/error\">zfp: expected a rate"), std::string::npos);
  EXPECT_NE(page().find("data-json=\"/cases/1/error\">opengl: expected"), std::string::npos);
  // The failed choice's cases, which say the same, are not listed again.
  EXPECT_EQ(page().find("data-json=\"/cases/6/error\""), std::string::npos);
}

TEST_F(hbComparisonPageTest, oneChoiceOnly) {
  write(hb::test::smallReport(), true);
  EXPECT_EQ(findings(), "");
  EXPECT_NE(page().find("Every case could be measured."), std::string::npos);
  EXPECT_EQ(page().find("Hard cases"), std::string::npos);
}

TEST_F(hbComparisonPageTest, hardCasesShowWhatIsBeyondItsBound) {
  write(hb::test::report());
  const std::string cell = "<td class=\"name\">";
  for (const char* text : {"exceeded", "no statement"})
    EXPECT_NE(page().find(cell + text + "</td>"), std::string::npos) << text;
  for (const char* path : {"2/share", "2/error_of_range", "0/share"})
    EXPECT_NE(page().find(std::string("data-json=\"/hard_cases/cases/0/results/") + path), std::string::npos) << path;
}

TEST_F(hbComparisonPageTest, whatIsNotKnownIsADash) {
  Json report = hb::test::smallReport();
  for (auto& [key, value] : report["cases"][1].items())
    if (key != "key" && key != "choice" && key != "engine" && key != "mode" && key != "status" &&
        key != "seconds_frame")
      value = nullptr;
  for (auto& [key, value] : report["machine"].items()) value = nullptr;
  for (auto& [key, value] : report["choices"][1].items())
    if (key != "key" && key != "kind" && key != "label" && key != "status") value = nullptr;
  write(report);
  EXPECT_EQ(findings(), "");
}

TEST_F(hbComparisonPageTest, nothingMeasuredIsAPageToo) {
  Json report = hb::test::smallReport();
  for (Json& one : report["cases"]) one["status"] = "failed", one["error"] = "no memory";
  write(report);
  EXPECT_EQ(findings(), "");
  EXPECT_NE(page().find("No case of this mode could be measured."), std::string::npos);
}

TEST_F(hbComparisonPageTest, fitsAreShownWithWhatJudgedThem) {
  write(hb::test::report(), true);
  for (const char* words : {"held out", "Fits (", "error of the values over size"})
    EXPECT_EQ(page().find(words), std::string::npos) << words;
  const Json report = hb::test::fittedReport();
  write(report, true);
  EXPECT_EQ(findings(), "");
  const std::string html = page();
  for (const char* place : {"/settings/fits/0", "/settings/loss", "/choices/7/fit/held_out_rmse",
                            "/choices/8/fit/interpolation_held_out_rmse", "/choices/8/fit/seconds"})
    EXPECT_NE(html.find(std::string("data-json=\"") + place + '"'), std::string::npos) << place;
  for (const char* words : {"least squares, level 5 (interpolation kept)", "plot: error of the values over size"})
    EXPECT_NE(html.find(words), std::string::npos) << words;
}

TEST_F(hbComparisonPageTest, missingPlotsAreSaid) {
  write(hb::test::report());
  EXPECT_NE(page().find("The plots are missing"), std::string::npos);
}

TEST_F(hbComparisonPageTest, missingPicturesAreSaid) {
  Json report = hb::test::report();
  report["plots"]["error_time"]["xray"] = "plots/error-time-xray.svg";
  write(report);
  EXPECT_NE(page().find("Picture missing: <span data-json=\"/plots/error_time/xray\">plots/error-time-xray.svg<"),
            std::string::npos);
  EXPECT_EQ(page().find("data-json=\"/cases/0/image\""), std::string::npos);
  std::filesystem::remove(folder_ / "pictures/original-full-xray.png");
  hb::writeComparisonPage(report, folder_.path());
  EXPECT_EQ(findings(), "");
  EXPECT_NE(page().find("Picture missing: <span data-json=\"/cases/0/image\">pictures/original-full-xray.png<"),
            std::string::npos);
}

TEST_F(hbComparisonPageTest, pagesStayBelow10MB) {
  Json report = hb::test::report();
  hb::test::writePictures(report, folder_.path());
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "pictures"))
    std::filesystem::resize_file(entry.path(), 800000); // some 20 of them are shown
  save("report.json", report.dump());
  hb::writeComparisonPage(report, folder_.path());
  EXPECT_EQ(findings(), "");
  EXPECT_LT(page().size(), 10U << 20U);
  EXPECT_GT(page().size(), 8U << 20U);
  EXPECT_NE(page().find("Left out for its size: "), std::string::npos);
  // References come before differences.
  EXPECT_EQ(page().find("data-json=\"/cases/0/image\""), std::string::npos);
}

std::vector<std::string> keysOf(const std::vector<hbReportPlace>& cases) {
  std::vector<std::string> keys;
  for (const auto& one : cases) keys.push_back(one["key"].text());
  return keys;
}

TEST(hbComparisonPage, orderIsByTheChoicesErrorThenByTime) {
  Json report = hb::test::report(); // errors fall, times rise, with the place of a case
  EXPECT_EQ(keysOf(hb::casesInOrder(hbReportPlace(report), "xray")),
            (std::vector<std::string>{"original-full-xray", "zfp-6-full-xray", "coarse-6-full-xray",
                                      "coarse-5-full-xray", "sparse-6-seminodal-xray", "sparse-6-opengl-xray",
                                      "sparse-5-seminodal-xray", "sparse-5-opengl-xray"}));
  report["cases"][0]["picture"] = nullptr; // unknown comes last
  EXPECT_EQ(keysOf(hb::casesInOrder(hbReportPlace(report), "xray")).back(), "original-full-xray");
}

TEST_F(hbComparisonPageTest, errorsOfImagesAreADash) {
  Json report = hb::test::report();
  report["cases"].push_back(hb::test::vtkCase(report, "mip"));
  write(report);
  EXPECT_EQ(findings(), "");
  const std::string html = page(), place = "data-json=\"/cases/18/";
  for (const char* key : {"picture/max", "picture/rmse", "picture/psnr"})
    EXPECT_EQ(html.find(place + key + '"'), std::string::npos) << key;
  for (const char* key : {"picture/ssim", "picture/luv_mean", "picture/luv_max", "seconds_frame/median"})
    EXPECT_NE(html.find(place + key + '"'), std::string::npos) << key;
  EXPECT_NE(html.find("alt=\"the volume itself by vtk-gpu, mip\""), std::string::npos); // with a caption
}

TEST(hbComparisonPage, imagesComeLastOfTheirChoice) {
  Json report = hb::test::report();
  report["cases"].push_back(hb::test::vtkCase(report, "mip"));
  report["cases"][9]["picture"]["rmse"] = 5.0; // the reference, if it had an error above VTK's number
  const auto keys = keysOf(hb::casesInOrder(hbReportPlace(report), "mip"));
  ASSERT_EQ(keys.size(), 9U);
  EXPECT_EQ(keys[0], "sparse-6-seminodal-mip"); // without an error
  const auto full = std::find(keys.begin(), keys.end(), "original-full-mip");
  ASSERT_NE(full, keys.end());
  EXPECT_EQ(*(full + 1), "original-vtk-gpu-mip");
}

TEST(hbComparisonPage, aPictureAChoiceIsShownAndTheReferenceFirst) {
  Json report = hb::test::report();
  for (Json& one : report["cases"]) // nothing looks different
    if (one["picture"].is_object()) one["picture"]["luv_mean"] = 2.0;
  const std::vector<std::string> each{"original-full-mip", "sparse-6-seminodal-mip", "zfp-6-full-mip",
                                      "coarse-6-full-mip", "coarse-5-full-mip",      "sparse-5-seminodal-mip"};
  EXPECT_EQ(keysOf(hb::casesToShow(hbReportPlace(report), "mip")), each);

  auto with = each; // a choice's other engine that looks different is shown after it
  with.emplace_back("sparse-5-opengl-mip");
  for (Json& one : report["cases"])
    if (one["key"] == "sparse-5-opengl-mip") one["picture"]["luv_mean"] = 3.5;
  EXPECT_EQ(keysOf(hb::casesToShow(hbReportPlace(report), "mip")), with);
}

} // namespace
