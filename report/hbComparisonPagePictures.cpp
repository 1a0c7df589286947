#include "report/hbComparisonPagePictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "report/hbComparisonPageTables.h"
#include "report/hbDataUri.h"

namespace {

/// Of all pictures on the page: with 4/3 for their coding, tables and plots the page stays below 10 MB.
constexpr std::uint64_t kPictureBytes = 13U << 19U;
constexpr auto kMissing = "Picture missing: ";

std::vector<std::string> modesOf(const hbReportPlace& report) {
  std::vector<std::string> modes;
  for (std::size_t i = 0; i < report["settings"]["modes"].size(); ++i)
    modes.push_back(report["settings"]["modes"][i].text());
  return modes;
}

bool isReference(const hbReportPlace& one) {
  return one["choice"].text() == "original" && one["engine"].text() == "full";
}

bool looksDifferent(const hbReportPlace& a, const hbReportPlace& b) {
  constexpr double kJustSeen = 1.0;
  const auto luvA = a["picture"]["luv_mean"].number(), luvB = b["picture"]["luv_mean"].number();
  return luvA && luvB && std::abs(*luvA - *luvB) > kJustSeen;
}

/// None where there is no such file.
std::optional<std::uint64_t> bytesOf(const std::filesystem::path& path) {
  std::error_code missing;
  const std::uint64_t bytes = std::filesystem::file_size(path, missing);
  return missing ? std::nullopt : std::optional(bytes);
}

/// Instead of a picture: why it is not here, and its path.
void writeNote(hbHtmlWriter& page, const char* why, const hbReportPlace& path) {
  page.open("span", {{"class", "left-out"}});
  page.text(why);
  page.quote(path);
  page.close();
}

} // namespace

std::vector<hbReportPlace> hb::casesToShow(const hbReportPlace& report, const std::string& mode) {
  std::vector<hbReportPlace> shown;
  auto cases = casesInOrder(report, mode); // the fastest of a choice comes first
  std::stable_partition(cases.begin(), cases.end(), isReference);
  for (const auto& one : cases) {
    if (one["image"].null()) continue;
    const auto first = std::find_if(shown.begin(), shown.end(), [&](const hbReportPlace& other) {
      return other["choice"].value() == one["choice"].value();
    });
    if (first == shown.end() || looksDifferent(*first, one)) shown.push_back(one);
  }
  return shown;
}

hbComparisonPagePictures::hbComparisonPagePictures(const hbReportPlace& report, std::filesystem::path folder)
    : report_(report), folder_(std::move(folder)) {
  std::uint64_t left = kPictureBytes;
  for (const char* key : {"image", "difference"}) // pictures of all modes before any difference
    for (const std::string& mode : modesOf(report))
      for (const auto& one : hb::casesToShow(report, mode)) {
        const std::string path = one[key].text();
        if (path.empty()) continue;
        const auto bytes = bytesOf(folder_ / path);
        if (!bytes || *bytes > left) continue;
        left -= *bytes;
        inlined_.insert(path);
      }
}

void hbComparisonPagePictures::writeImage(hbHtmlWriter& page, const hbReportPlace& path,
                                          const std::string& description) const {
  if (path.null()) return;
  if (inlined_.contains(path.text())) {
    page.empty("img", {{"src", hb::dataUri(folder_ / path.text(), "image/png")}, {"alt", description}});
    return;
  }
  writeNote(page, bytesOf(folder_ / path.text()) ? "Left out for its size: " : kMissing, path);
}

void hbComparisonPagePictures::writeCase(hbHtmlWriter& page, const hbReportPlace& one) const {
  const auto label = hb::choiceOf(report_, one["choice"].text())["label"];
  const std::string description = fmt::format("{} by {}, {}", label.text(), one["engine"].text(), one["mode"].text());
  page.open("figure");
  page.open("div", {{"class", "pair"}});
  writeImage(page, one["image"], description);
  writeImage(page, one["difference"], "difference to the reference: " + description);
  page.close();
  page.open("figcaption");
  page.open("b");
  page.quote(label);
  page.close();
  page.text(" by ");
  page.quote(one["engine"]);
  page.empty("br");
  page.figure(one["compressed_bytes"], {"kB", 1024.0});
  page.text(" kB, ");
  page.figure(one["seconds_frame"]["median"], {"ms", 1e-3});
  page.text(" ms; ");
  if (isReference(one)) {
    page.text("the reference");
  } else {
    if (hb::hasPictureValues(one)) {
      page.text("RMSE ");
      page.figure(one["picture"]["rmse"]);
      page.text(", ");
    }
    page.text("L*u*v* ");
    page.figure(one["picture"]["luv_mean"]);
  }
  page.close();
  page.close();
}

void hbComparisonPagePictures::write(hbHtmlWriter& page, const std::string& mode) const {
  page.open("div", {{"class", "pictures"}});
  for (const auto& one : hb::casesToShow(report_, mode)) writeCase(page, one);
  page.close();
}

void hbComparisonPagePictures::writePlot(hbHtmlWriter& page, const hbReportPlace& place,
                                         const char* description) const {
  if (place.null()) return;
  page.open("figure");
  if (bytesOf(folder_ / place.text()))
    page.empty("img", {{"src", hb::dataUri(folder_ / place.text(), "image/svg+xml")}, {"alt", description}});
  else
    writeNote(page, kMissing, place);
  page.close();
}
