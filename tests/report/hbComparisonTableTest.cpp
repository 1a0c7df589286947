#include "report/hbComparisonTable.h"

#include <clocale>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/report/hbTestReport.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

/// A reader of RFC 4180 of its own: rows of cells.
std::vector<std::vector<std::string>> parse(std::string_view text) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      rows.back().back() += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      rows.back().emplace_back();
    } else if (c == '\r' && !quoted) {
      EXPECT_EQ(text.substr(i, 2), "\r\n");
      ++i;
      rows.push_back({""});
    } else {
      rows.back().back() += c;
    }
  }
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}); // the last line ends too
  rows.pop_back();
  return rows;
}

std::string cell(const std::vector<std::vector<std::string>>& rows, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < rows[0].size(); ++i)
    if (rows[0][i] == column) return rows[row][i];
  return "no column " + column;
}

TEST(hbComparisonTable, hasARowACaseWithAllDigits) {
  const Json report = hb::test::report();
  const auto rows = parse(hb::comparisonTable(report));
  ASSERT_EQ(rows.size(), 1 + report["cases"].size());
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  for (std::size_t i = 0; i < report["cases"].size(); ++i) {
    const Json& one = report["cases"][i];
    EXPECT_EQ(cell(rows, i + 1, "key"), one["key"]);
    if (one["status"] == "failed") continue;
    EXPECT_EQ(std::stod(cell(rows, i + 1, "seconds_frame_median")), one["seconds_frame"]["median"].get<double>());
    EXPECT_EQ(std::stod(cell(rows, i + 1, "picture_rmse")), one["picture"]["rmse"].get<double>());
    EXPECT_EQ(cell(rows, i + 1, "pareto_time"), one["pareto_time"] == true ? "true" : "false");
  }
}

TEST(hbComparisonTable, hasTheChoiceOfEachCase) {
  const auto rows = parse(hb::comparisonTable(hb::test::report()));
  EXPECT_EQ(cell(rows, 1, "choice_label"), "the volume itself");
  EXPECT_EQ(cell(rows, 1, "choice_size_1"), "217");
  EXPECT_EQ(cell(rows, 1, "choice_values_rmse"), "0.0");
  EXPECT_EQ(cell(rows, 1, "choice_values_psnr"), "");
  EXPECT_EQ(cell(rows, 4, "choice_label"), "sparse grid, level 6");
  EXPECT_EQ(cell(rows, 4, "choice_values_rmse"), "20.41234567890123");
  EXPECT_EQ(cell(rows, 4, "choice_size_1"), "");
}

TEST(hbComparisonTable, whatIsNullOnceHasNoColumnOfItsOwnBesideItsParts) {
  const auto rows = parse(hb::comparisonTable(hb::test::report()));
  EXPECT_EQ(cell(rows, 1, "picture"), "no column picture"); // null in the failed case
  EXPECT_EQ(cell(rows, 1, "true_picture"), "");             // null in all
}

TEST(hbComparisonTable, quotesWhatWouldBreakTheTable) {
  Json report = hb::test::smallReport();
  report["cases"][1]["error"] = "a,b\r\n\"c\" \xc3\x84";
  EXPECT_EQ(cell(parse(hb::comparisonTable(report)), 2, "error"), "a,b\r\n\"c\" \xc3\x84");
}

TEST(hbComparisonTable, localeChangesNothing) {
  const std::string before = hb::comparisonTable(hb::test::report());
  const std::string locale = std::setlocale(LC_ALL, nullptr);
  std::setlocale(LC_ALL, "de_DE.UTF-8"); // where it is installed
  EXPECT_EQ(hb::comparisonTable(hb::test::report()), before);
  std::setlocale(LC_ALL, locale.c_str());
}

TEST(hbComparisonTable, isWrittenWholeOrNotAtAll) {
  const hbTestFolder folder;
  hb::writeComparisonTable(hb::test::smallReport(), folder / "report.csv");
  const auto bytes = hb::test::readFile(folder / "report.csv");
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()),
            hb::comparisonTable(hb::test::smallReport()));
  EXPECT_EQ(folder.files(), 1);
  EXPECT_THROW(hb::writeComparisonTable(hb::test::smallReport(), folder / "none" / "report.csv"), hbError);
}

} // namespace
