#include "report/hbComparisonPage.h"

#include <cstddef>
#include <string>

#include "report/hbComparisonPagePictures.h"
#include "report/hbComparisonPageTables.h"
#include "report/hbHtmlWriter.h"
#include "report/hbReportPlace.h"
#include "volume/hbTextFile.h"

namespace {

constexpr auto kTimes = " \xc3\x97 ";

/// Without <, >, & and ", which the writer escapes: HTML, unlike XML, takes a style as it stands.
constexpr auto kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, 'DejaVu Sans', sans-serif; color: #1a1a1a; background: #fff;
  max-width: 1180px; margin: 0 auto; padding: 0 16px 48px; }
h1 { font-size: 26px; margin: 28px 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 20px; margin: 40px 0 8px; padding-top: 8px; border-top: 2px solid #0072b2; }
h3 { font-size: 16px; margin: 24px 0 6px; }
p { max-width: 75ch; margin: 8px 0; }
a { color: #005a8c; }
nav a { margin-right: 14px; white-space: nowrap; }
.wide { overflow-x: auto; margin: 8px 0; }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 7px; text-align: right; white-space: nowrap; border-bottom: 1px solid #e3e6ea; }
thead th { vertical-align: bottom; white-space: normal; line-height: 1.25; background: #fff; border-bottom: 2px solid #8a929b; }
thead small { display: block; font-weight: 400; color: #555; }
.name { text-align: left; }
tbody th { font-weight: 400; }
tr.choice th { text-align: left; white-space: normal; background: #eef2f6; color: #333; }
tr.choice b { margin-right: 14px; color: #000; }
tr.front { background: #fdf6e3; }
td.name { white-space: normal; overflow-wrap: anywhere; min-width: 60px; }
.mark { margin-left: 6px; padding: 0 5px; border-radius: 3px; font-size: 11px; color: #fff; }
.mark.time { background: #0072b2; }
.mark.size { background: #a84300; }
figure { margin: 0; }
img { max-width: 100%; height: auto; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 460px), 1fr)); gap: 12px; }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 340px), 1fr)); gap: 16px 12px; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 3px; align-items: start; }
.pair img { width: 100%; }
figcaption, .left-out { font-size: 12.5px; line-height: 1.4; color: #333; }
.left-out { overflow-wrap: anywhere; }
dl.facts, dl.meanings { display: grid; grid-template-columns: max-content 1fr; gap: 2px 16px; font-size: 14px; }
dt { color: #555; }
dd { margin: 0; overflow-wrap: anywhere; }
code { font: 13px/1.5 'DejaVu Sans Mono', monospace; overflow-wrap: anywhere; }
@media print {
  body { max-width: none; font-size: 11px; padding: 0; }
  h2 { break-after: avoid; }
  figure, tr { break-inside: avoid; }
  nav { display: none; }
  .wide { overflow: visible; }
  table { font-size: 8px; }
  .mark { font-size: 7px; padding: 0 3px; }
  th, td { padding: 1px 4px; }
  tr.choice th, tr.front, .mark { print-color-adjust: exact; }
}
@media (max-width: 600px) {
  body { font-size: 14px; padding: 0 10px 32px; }
  dl.facts, dl.meanings { grid-template-columns: 1fr; }
  dd { margin-bottom: 6px; }
}
)";

/// The elements of an array, each as `write` does, with `between` them.
template <class Write>
void writeList(hbHtmlWriter& page, const hbReportPlace& array, const char* between, Write write) {
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (i > 0) page.text(between);
    write(array[i]);
  }
}

class Page {
public:
  Page(const hbReportPlace& report, const std::filesystem::path& folder) : report_(report), pictures_(report, folder) {}

  std::string html() {
    page_.open("html", {{"xmlns", "http://www.w3.org/1999/xhtml"}, {"lang", "en"}, {"xml:lang", "en"}});
    writeHead();
    page_.open("body");
    writeTitle();
    page_.element("h2", "Recommendations", {{"id", "recommendations"}});
    hb::writeRecommendations(page_, report_);
    writeReading();
    writeKept();
    const auto modes = report_["settings"]["modes"];
    for (std::size_t i = 0; i < modes.size(); ++i) writeMode(modes[i]);
    page_.element("h2", "Failed cases", {{"id", "failed"}});
    hb::writeFailures(page_, report_);
    hb::writeHardCases(page_, report_);
    writeMeasuring();
    page_.element("h2", "What the columns mean", {{"id", "columns"}});
    hb::writeColumnMeanings(page_, report_);
    page_.close();
    page_.close();
    return "<!DOCTYPE html>\n" + page_.html();
  }

private:
  void writeHead() {
    page_.open("head");
    page_.empty("meta", {{"charset", "utf-8"}});
    page_.empty("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}});
    page_.element("title", "hbvol compare: " + report_["input"]["name"].text());
    page_.element("style", kStyle);
    page_.close();
  }

  void writeTitle() {
    const auto input = report_["input"];
    page_.open("h1");
    page_.text("Speed against error: ");
    page_.quote(input["name"]);
    page_.close();
    page_.open("p");
    page_.text(input["representation"].text() == "analytic" ? "An analytic field, sampled at " : "A volume of ");
    writeList(page_, input["size"], kTimes, [&](const auto& place) { page_.figure(place); });
    page_.text(" samples (");
    page_.figure(input["samples"]);
    page_.text("), component ");
    page_.figure(input["component"]);
    page_.text(", values from ");
    writeList(page_, input["range"], " to ", [&](const auto& place) { page_.figure(place); });
    page_.text("; ");
    page_.figure(input["bytes_uncompressed"], {"kB", 1024.0});
    page_.text(" kB uncompressed.");
    page_.close();
    writeContents();
  }

  void writeContents() {
    page_.open("nav");
    page_.element("a", "What is kept", {{"href", "#kept"}});
    writeList(page_, report_["settings"]["modes"], "", [&](const auto& mode) {
      page_.open("a", {{"href", "#mode-" + mode.text()}});
      page_.text("Mode ");
      page_.quote(mode);
      page_.close();
    });
    page_.element("a", "Failed cases", {{"href", "#failed"}});
    page_.element("a", "How it was measured", {{"href", "#measured"}});
    page_.element("a", "What the columns mean", {{"href", "#columns"}});
    page_.close();
  }

  void writeReading() {
    page_.element("h2", "How to read this page", {{"id", "reading"}});
    page_.element(
        "p", "A choice is what is kept of the volume: the volume itself, a sparse grid of some level, or, as an honest "
             "baseline, a coarser full grid or another compressor's file of about as many bytes. An engine turns it "
             "into a picture of a mode. Each picture is set against the reference: the full grid's picture of the same "
             "view and samples. Tables begin with the choice whose picture is closest to it. A row marked \"time\" is "
             "on the Pareto front of time and error: nothing measured is both faster and closer. One marked \"size\" "
             "is on that of bytes and error. Sizes in kB count by powers of two. A dash stands for what is unknown or "
             "does not apply; where nothing differs, or the reference has one value only, there is no PSNR.");
    page_.open("p");
    page_.text("All figures stand with all their digits in ");
    page_.element("a", "report.json", {{"href", "report.json"}});
    page_.text(" and ");
    page_.element("a", "report.csv", {{"href", "report.csv"}});
    page_.text(" beside this page.");
    page_.close();
  }

  void writeKept() {
    page_.element("h2", "What is kept", {{"id", "kept"}});
    hb::writeChoiceTable(page_, report_);
    if (!report_["settings"]["fits"].null()) writeFits();
    if (report_["plots"].null())
      page_.element("p", "The plots are missing, as gnuplot could not be used when this page was made.");
    const auto convergence = report_["plots"]["convergence"];
    page_.open("div", {{"class", "plots"}});
    pictures_.writePlot(page_, convergence["values"], "plot: error of the values over the level");
    pictures_.writePlot(page_, convergence["true_values"], "plot: error against the analytic field over the level");
    pictures_.writePlot(page_, convergence["bytes"], "plot: error of the values over size");
    page_.close();
  }

  void writeFits() {
    page_.open("p");
    page_.text("Fits (");
    writeList(page_, report_["settings"]["fits"], ", ", [&](const auto& fit) { page_.quote(fit); });
    page_.text("; loss: ");
    page_.quote(report_["settings"]["loss"]);
    page_.text(
        ") are sparse grids of the same levels whose values were fitted to all samples, where interpolation looks at "
        "those at its nodes only. Some samples were held out of the fit to judge it; where it was no better on these, "
        "interpolation was kept. At the same level a fit takes other bytes than interpolation: the plots over size "
        "have the bytes of the files. Fits are drawn by the first engine only, as their grids, and so the times, are "
        "those of interpolation.");
    page_.close();
  }

  void writeMode(const hbReportPlace& mode) {
    const std::string name = mode.text();
    page_.open("h2", {{"id", "mode-" + name}});
    page_.text("Mode ");
    page_.quote(mode);
    page_.close();
    hb::writeModeTable(page_, report_, name);
    page_.open("div", {{"class", "plots"}});
    const auto plots = report_["plots"];
    pictures_.writePlot(page_, plots["error_time"][name.c_str()], "plot: error of the picture over time");
    pictures_.writePlot(page_, plots["error_bytes"][name.c_str()], "plot: error of the picture over size");
    pictures_.writePlot(page_, plots["time_level"][name.c_str()], "plot: time over level");
    page_.close();
    page_.element("h3", "Pictures");
    page_.element("p",
                  "The reference, then each choice by its fastest engine (and by others where they look different), "
                  "with its difference to the reference beside it.");
    pictures_.write(page_, name);
  }

  template <class Write>
  void writeFact(const char* name, Write write) {
    page_.element("dt", name);
    page_.open("dd");
    write();
    page_.close();
  }

  void writeFacts(const hbReportPlace& place, std::initializer_list<std::pair<const char*, const char*>> facts) {
    for (const auto& [name, key] : facts)
      writeFact(name, [&, &k = key] {
        if (place[k].number())
          page_.figure(place[k]);
        else
          page_.quote(place[k]);
      });
  }

  void writeMeasuring() {
    const auto machine = report_["machine"], settings = report_["settings"], peers = report_["peers"];
    page_.element("h2", "How it was measured", {{"id", "measured"}});
    page_.open("dl", {{"class", "facts"}});
    writeFact("command", [&] {
      page_.open("code");
      page_.quote(report_["command"]);
      page_.close();
    });
    writeFacts(report_, {{"hbvol", "version"}, {"sittings", "runs"}});
    writeFacts(machine, {{"processor", "processor"}, {"cores", "cores"}, {"threads used", "threads"}});
    writeFact("memory", [&] {
      page_.figure(machine["memory_bytes"], {"MB", 1048576.0});
      page_.text(" MB");
    });
    writeFacts(machine, {{"system", "system"},
                         {"compiler", "compiler"},
                         {"instruction set", "instruction_set"},
                         {"OpenGL renderer", "gl_renderer"}});
    writeFacts(peers, {{"zfp", "zfp"}, {"VTK", "vtk"}});
    writeFact("pictures", [&] {
      page_.figure(settings["width"]);
      page_.text(kTimes);
      page_.figure(settings["height"]);
      page_.text(" pixels");
    });
    writeFacts(settings, {{"samples over the depth", "samples"}, {"sampling", "sampling"}, {"repeats", "repeats"}});
    writeFact("levels", [&] { writeList(page_, settings["levels"], ", ", [&](const auto& p) { page_.figure(p); }); });
    writeFact("engines", [&] { writeList(page_, settings["engines"], ", ", [&](const auto& p) { page_.quote(p); }); });
    page_.close();
    page_.element("p", "Times are of the machine as it was: other programs and the processor's clock show in the "
                       "spread. Where there was more than one sitting, an interrupted comparison was continued, and "
                       "report.json says for each case in which one it was measured.");
  }

  const hbReportPlace report_;
  hbComparisonPagePictures pictures_;
  hbHtmlWriter page_;
};

} // namespace

void hb::writeComparisonPage(const nlohmann::ordered_json& report, const std::filesystem::path& folder) {
  saveText(Page(hbReportPlace(report), folder).html(), folder / "index.html");
}
