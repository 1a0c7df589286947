#include "report/hbComparisonPageTables.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

namespace {

using Path = std::vector<const char*>;

constexpr hbUnit kMilliseconds{"ms", 1e-3}, kKilobytes{"kB", 1024.0}, kMillions{"M/s", 1e6}, kDecibels{"dB", 1.0};
constexpr hbUnit kSimilarity{"", 1.0, 4};
constexpr auto kEnDash = "\xe2\x80\x93";

/// A column of figures, or of two joined by a dash.
struct Column {
  const char* title;
  const char* meaning;
  std::vector<Path> paths;
  hbUnit unit;
  bool optional = false; ///< Left out where no row has it.
  bool ofValues = false; ///< A dash for cases without hb::hasPictureValues().
};

const std::vector<Column> kChoiceColumns{
    {"level", "of a sparse grid; of others: that of the sparse grid which takes about as many bytes", {{"level"}}, {}},
    {"compressed", "bytes kept, as in a file", {{"bytes"}}, kKilobytes},
    {"bits a sample", "compressed size over the samples of the volume", {{"bits_per_sample"}}, {}},
    {"build", "time to make it from the volume", {{"seconds_build"}}, kMilliseconds},
    {"value max", "largest error of a value against the volume's samples", {{"values", "max"}}, {}},
    {"value RMSE", "root of the mean squared error of the values", {{"values", "rmse"}}, {}},
    {"value PSNR",
     "the range of values over that RMSE; none where nothing differs or the samples have one value only",
     {{"values", "psnr"}},
     kDecibels},
    {"held out RMSE",
     "root of the mean squared error at the samples held out of a fit",
     {{"fit", "held_out_rmse"}},
     {},
     true},
    {"held out, interpolation",
     "the same of interpolation at the same level",
     {{"fit", "interpolation_held_out_rmse"}},
     {},
     true},
    {"fit", "time of the fit alone", {{"fit", "seconds"}}, kMilliseconds, true},
    {"order",
     "log(RMSE before / RMSE) / log(mesh width before / mesh width) between neighbouring levels",
     {{"order"}},
     {}},
    {"true max", "largest error against the analytic field itself", {{"true_values", "max"}}, {}, true},
    {"true RMSE", "root of the mean squared error against the analytic field", {{"true_values", "rmse"}}, {}, true},
    {"true order", "as order, of the RMSE against the analytic field", {{"true_order"}}, {}, true}};

const std::vector<Column> kCaseColumns{
    {"frame",
     "time of a picture, the median of the repeats, after a warm-up",
     {{"seconds_frame", "median"}},
     kMilliseconds},
    {"spread",
     "fastest and slowest of the repeats",
     {{"seconds_frame", "min"}, {"seconds_frame", "max"}},
     kMilliseconds},
    {"samples",
     "millions a second, nominal: the length of all rays in the volume over the step, whatever an engine leaves out",
     {{"samples_per_second"}},
     kMillions},
    {"first picture",
     "reading what is kept, making the engine and one frame; of VTK without the reading",
     {{"seconds_first_picture"}},
     kMilliseconds},
    {"compressed", "bytes kept, as in a file", {{"compressed_bytes"}}, kKilobytes},
    {"resident", "bytes in memory to draw from", {{"resident_bytes"}}, kKilobytes},
    {"textures", "bytes of textures", {{"texture_bytes"}}, kKilobytes},
    {"picture max",
     "largest difference of a pixel to the reference picture, in the picture's values; none of VTK's pictures, which "
     "are images of bytes and compared as displayed",
     {{"picture", "max"}},
     {},
     false,
     true},
    {"picture RMSE",
     "root of the mean squared difference to the reference picture; none of VTK's",
     {{"picture", "rmse"}},
     {},
     false,
     true},
    {"picture PSNR",
     "the reference picture's range over that RMSE; none where nothing differs or the reference has one value only, "
     "and none of VTK's",
     {{"picture", "psnr"}},
     kDecibels,
     false,
     true},
    {"picture SSIM",
     "structural similarity to the reference picture as shown; one for equal pictures",
     {{"picture", "ssim"}},
     kSimilarity},
    {"L*u*v* mean",
     "mean distance of the colours shown in L*u*v*; one can just be seen",
     {{"picture", "luv_mean"}},
     {}},
    {"L*u*v* max", "largest distance of two colours shown", {{"picture", "luv_max"}}, {}},
    {"true RMSE",
     "root of the mean squared difference to the picture of the analytic field itself",
     {{"true_picture", "rmse"}},
     {},
     true},
    {"true SSIM",
     "structural similarity to the picture of the analytic field",
     {{"true_picture", "ssim"}},
     kSimilarity,
     true}};

const std::vector<Column> kHardColumns{
    {"error", "largest error against the reference", {{"error"}}, {}},
    {"of the range", "the same in parts of the range of the values", {{"error_of_range"}}, {}},
    {"bound", "derived bound of the error, the largest", {{"bound"}}, {}},
    {"of the bound", "largest error in parts of the bound where it is", {{"share"}}, {}}};

hbReportPlace at(hbReportPlace place, const Path& path) {
  for (const char* key : path) place = place[key];
  return place;
}

std::vector<hbReportPlace> elements(const hbReportPlace& array) {
  std::vector<hbReportPlace> result;
  for (std::size_t i = 0; i < array.size(); ++i) result.push_back(array[i]);
  return result;
}

std::vector<Column> columnsOf(const std::vector<Column>& columns, const std::vector<hbReportPlace>& rows) {
  std::vector<Column> result;
  for (const Column& column : columns) {
    const auto has = [&](const hbReportPlace& row) { return !at(row, column.paths[0]).null(); };
    if (!column.optional || std::any_of(rows.begin(), rows.end(), has)) result.push_back(column);
  }
  return result;
}

void openTable(hbHtmlWriter& page) {
  page.open("div", {{"class", "wide"}});
  page.open("table");
}

void closeTable(hbHtmlWriter& page) {
  page.close();
  page.close();
}

void writeHead(hbHtmlWriter& page, std::initializer_list<const char*> names, const std::vector<Column>& columns = {}) {
  page.open("thead");
  page.open("tr");
  for (const char* name : names) page.element("th", name, {{"class", "name"}, {"scope", "col"}});
  for (const Column& column : columns) {
    page.open("th", {{"scope", "col"}, {"title", column.meaning}});
    page.text(column.title);
    if (column.unit.name[0] != '\0') page.element("small", column.unit.name);
    page.close();
  }
  page.close();
  page.close();
}

void writeCell(hbHtmlWriter& page, const hbReportPlace& row, const Column& column) {
  if (column.ofValues && !hb::hasPictureValues(row)) return page.text(kEnDash);
  for (std::size_t i = 0; i < column.paths.size(); ++i) {
    if (i > 0) page.text(kEnDash);
    page.figure(at(row, column.paths[i]), column.unit);
  }
}

void writeFigures(hbHtmlWriter& page, const hbReportPlace& row, const std::vector<Column>& columns) {
  for (const Column& column : columns) {
    page.open("td");
    writeCell(page, row, column);
    page.close();
  }
}

void writeName(hbHtmlWriter& page, const char* tag, const hbReportPlace& place) {
  page.open(tag, {{"class", "name"}});
  page.quote(place);
  page.close();
}

/// "a sparse grid, level 8 · 83 kB · ...": what the rows below have in common.
void writeChoiceRow(hbHtmlWriter& page, const hbReportPlace& choice, std::size_t columns) {
  page.open("tr", {{"class", "choice"}});
  page.open("th", {{"colspan", std::to_string(columns)}, {"scope", "rowgroup"}});
  page.open("b");
  page.quote(choice["label"]);
  page.close();
  const auto add = [&](const char* before, const hbReportPlace& place, const hbUnit& unit, const char* after) {
    page.text(before);
    page.figure(place, unit);
    page.text(after);
  };
  add("", choice["bytes"], kKilobytes, " kB, ");
  add("", choice["bits_per_sample"], {}, " bits a sample; values: ");
  add("max ", choice["values"]["max"], {}, ", ");
  add("RMSE ", choice["values"]["rmse"], {}, ", ");
  add("PSNR ", choice["values"]["psnr"], {}, " dB");
  page.close();
  page.close();
}

void writeCaseRow(hbHtmlWriter& page, const hbReportPlace& one, const std::vector<Column>& columns) {
  const bool time = one["pareto_time"].truth(), bytes = one["pareto_bytes"].truth();
  page.open("tr", {{"class", time || bytes ? "front" : "behind"}});
  page.open("th", {{"class", "name"}, {"scope", "row"}});
  page.quote(one["engine"]);
  if (time)
    page.element("span", "time", {{"class", "mark time"}, {"title", "no other case is both faster and closer"}});
  if (bytes)
    page.element("span", "size", {{"class", "mark size"}, {"title", "no other case is both smaller and closer"}});
  page.close();
  writeFigures(page, one, columns);
  page.close();
}

double orLast(const std::optional<double>& number) { return number.value_or(std::numeric_limits<double>::infinity()); }

/// Rows of a failed choice or case: what, where, why.
void writeFailure(hbHtmlWriter& page, const hbReportPlace& label, const hbReportPlace* one,
                  const hbReportPlace& error) {
  page.open("tr");
  writeName(page, "td", label);
  for (const char* key : {"engine", "mode"}) {
    page.open("td", {{"class", "name"}});
    if (one != nullptr)
      page.quote((*one)[key]);
    else
      page.text("all");
    page.close();
  }
  writeName(page, "td", error);
  page.close();
}

const char* boundText(const hbReportPlace& result) {
  if (result["exceeds_bound"].truth()) return "exceeded";
  if (result["says_nothing"].truth()) return "no statement";
  return result["within_bound"].truth() ? "yes" : "";
}

void writeHardCase(hbHtmlWriter& page, const hbReportPlace& one) {
  const auto results = elements(one["results"]);
  page.open("tbody");
  page.open("tr", {{"class", "choice"}});
  page.open("th", {{"colspan", "10"}, {"scope", "rowgroup"}});
  page.open("b");
  page.quote(one["name"]);
  page.close();
  page.quote(one["why"]);
  page.text("; amplification ");
  page.figure(one["amplification"]);
  page.text("; most stable: ");
  page.quote(one["most_stable"]);
  page.text(", as ");
  page.quote(one["reason"]);
  page.close();
  page.close();
  for (const auto& result : results) {
    page.open("tr");
    for (const char* key : {"engine", "format", "status"}) writeName(page, "td", result[key]);
    page.element("td", result["stable"].truth() ? "yes" : "no", {{"class", "name"}});
    page.element("td", boundText(result), {{"class", "name"}});
    writeName(page, "td", result["note"]);
    writeFigures(page, result, kHardColumns);
    page.close();
  }
  page.close();
}

void writeMeanings(hbHtmlWriter& page, const std::vector<Column>& columns) {
  page.open("dl", {{"class", "meanings"}});
  for (const Column& column : columns) {
    page.element("dt", column.title);
    page.element("dd", column.meaning);
  }
  page.close();
}

} // namespace

hbReportPlace hb::choiceOf(const hbReportPlace& report, const std::string& key) {
  const auto choices = report["choices"];
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (choices[i]["key"].text() == key) return choices[i];
  return choices[choices.size()];
}

bool hb::hasPictureValues(const hbReportPlace& one) { return !one["image_only"].truth(); }

std::vector<hbReportPlace> hb::casesInOrder(const hbReportPlace& report, const std::string& mode) {
  std::vector<hbReportPlace> cases;
  std::map<std::string, double> least; // picture error of a choice
  for (const auto& one : elements(report["cases"])) {
    if (one["mode"].text() != mode || one["status"].text() != "done") continue;
    cases.push_back(one);
    const double error = orLast(hasPictureValues(one) ? one["picture"]["rmse"].number() : std::nullopt);
    const auto [entry, added] = least.emplace(one["choice"].text(), error);
    entry->second = std::min(entry->second, error);
  }
  const auto rank = [&](const hbReportPlace& one) {
    const std::string choice = one["choice"].text();
    return std::tuple(least.at(choice), orLast(choiceOf(report, choice)["bytes"].number()), choice,
                      !hasPictureValues(one), orLast(one["seconds_frame"]["median"].number()));
  };
  std::stable_sort(cases.begin(), cases.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return cases;
}

void hb::writeChoiceTable(hbHtmlWriter& page, const hbReportPlace& report) {
  const auto choices = elements(report["choices"]);
  const auto columns = columnsOf(kChoiceColumns, choices);
  openTable(page);
  writeHead(page, {"choice"}, columns);
  page.open("tbody");
  for (const auto& choice : choices) {
    if (choice["status"].text() != "done") continue;
    page.open("tr");
    writeName(page, "th", choice["label"]);
    writeFigures(page, choice, columns);
    page.close();
  }
  page.close();
  closeTable(page);
}

void hb::writeModeTable(hbHtmlWriter& page, const hbReportPlace& report, const std::string& mode) {
  const auto cases = casesInOrder(report, mode);
  if (cases.empty()) return page.element("p", "No case of this mode could be measured.");
  const auto columns = columnsOf(kCaseColumns, cases);
  openTable(page);
  writeHead(page, {"engine"}, columns);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::string choice = cases[i]["choice"].text();
    if (i == 0 || cases[i - 1]["choice"].text() != choice) {
      if (i > 0) page.close();
      page.open("tbody");
      writeChoiceRow(page, choiceOf(report, choice), columns.size() + 1);
    }
    writeCaseRow(page, cases[i], columns);
  }
  page.close();
  closeTable(page);
}

void hb::writeRecommendations(hbHtmlWriter& page, const hbReportPlace& report) {
  const auto answers = elements(report["recommendations"]);
  if (answers.empty()) return page.element("p", "None was asked for.");
  openTable(page);
  writeHead(page, {"for", "mode", "take"});
  page.open("tbody");
  for (const auto& one : answers) {
    page.open("tr");
    for (const char* key : {"question", "mode", "answer"}) writeName(page, "td", one[key]);
    page.close();
  }
  page.close();
  closeTable(page);
}

void hb::writeFailures(hbHtmlWriter& page, const hbReportPlace& report) {
  const auto failed = [](const hbReportPlace& place) { return place["status"].text() == "failed"; };
  const auto choices = elements(report["choices"]), cases = elements(report["cases"]);
  if (std::none_of(choices.begin(), choices.end(), failed) && std::none_of(cases.begin(), cases.end(), failed))
    return page.element("p", "Every case could be measured.");
  openTable(page);
  writeHead(page, {"choice", "engine", "mode", "error"});
  page.open("tbody");
  for (const auto& choice : choices)
    if (failed(choice)) writeFailure(page, choice["label"], nullptr, choice["error"]);
  for (const auto& one : cases) {
    const auto choice = choiceOf(report, one["choice"].text());
    const bool said = failed(choice) && choice["error"].value() == one["error"].value();
    if (failed(one) && !said) writeFailure(page, choice["label"], &one, one["error"]);
  }
  page.close();
  closeTable(page);
}

void hb::writeHardCases(hbHtmlWriter& page, const hbReportPlace& report) {
  const auto cases = elements(report["hard_cases"]["cases"]);
  if (cases.empty()) return;
  page.element("h2", "Hard cases");
  page.element("p",
               "Fields chosen because rounding hurts there: the largest error of each engine against a reference "
               "in double precision, and the bound derived for it, which makes no statement where it is the range of "
               "the values or more. The amplification is how much rounding can "
               "grow in the sum of component grids.");
  openTable(page);
  writeHead(page, {"engine", "format", "status", "stable", "within bound", "note"}, kHardColumns);
  for (const auto& one : cases) writeHardCase(page, one);
  closeTable(page);
}

void hb::writeColumnMeanings(hbHtmlWriter& page, const hbReportPlace& report) {
  page.element("h3", "Of what is kept");
  writeMeanings(page, columnsOf(kChoiceColumns, elements(report["choices"])));
  page.element("h3", "Of a mode");
  writeMeanings(page, columnsOf(kCaseColumns, elements(report["cases"])));
}
