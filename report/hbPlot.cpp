#include "report/hbPlot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "report/hbLogAxis.h"
#include "volume/hbError.h"

namespace {

/// A string of gnuplot's: within single quotes only they themselves have a meaning.
std::string quoted(const std::string& text) {
  std::string result(1, '\'');
  for (const char c : text) {
    const bool control = static_cast<unsigned char>(c) < ' ';
    result.append(c == '\'' ? 2 : 1, control ? ' ' : c);
  }
  result += '\'';
  return result;
}

/// All values of one coordinate.
std::vector<double> coordinates(const hbPlot& plot, double std::pair<double, double>::*coordinate) {
  std::vector<double> values;
  for (const auto& series : plot.series)
    for (const auto& point : series.points) values.push_back(point.*coordinate);
  return values;
}

std::string rangeAndTicks(char axis, double lo, double hi, const std::vector<hbLogAxis::Tick>& ticks) {
  std::string list;
  for (const auto& tick : ticks) list += fmt::format("{}'{}' {}", list.empty() ? "" : ", ", tick.label, tick.value);
  return fmt::format("set {0}range [{1}:{2}]\nset {0}tics ({3})\n", axis, lo, hi, list);
}

std::string logarithmic(char axis, const hbLogAxis& scale) {
  return fmt::format("set logscale {}\n", axis) + rangeAndTicks(axis, scale.lo, scale.hi, scale.ticks);
}

std::string integral(char axis, const std::vector<double>& values) {
  std::vector<hbLogAxis::Tick> ticks;
  for (const double value : std::set<double>(values.begin(), values.end()))
    if (value == std::floor(value)) ticks.push_back({value, fmt::format("{:.0f}", value)});
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return rangeAndTicks(axis, *least - 0.3, *greatest + 0.3, ticks);
}

std::string style(const hbPlot::Series& series) {
  if (series.line == hbPlot::Line::none)
    return fmt::format("with points lc rgb '{}' pt {} ps 0.8", series.color, series.point);
  const int dashes = series.line == hbPlot::Line::solid ? 1 : series.line == hbPlot::Line::dashed ? 2 : 3;
  return fmt::format("with {} lc rgb '{}' dt {} lw {}{}", series.point > 0 ? "linespoints" : "lines", series.color,
                     dashes, series.width, series.point > 0 ? fmt::format(" pt {} ps 0.7", series.point) : "");
}

} // namespace

bool hbPlot::empty() const {
  return std::all_of(series.begin(), series.end(), [](const Series& one) { return one.points.empty(); });
}

std::string hbPlot::svg(const hbExternalProgram& gnuplot, hbProgress& progress) const {
  constexpr int kWidth = 620, kHeight = 380, kLegendColumns = 2, kLegendRow = 20;
  const auto xs = coordinates(*this, &std::pair<double, double>::first);
  const auto ys = coordinates(*this, &std::pair<double, double>::second);
  const hbLogAxis x = hbLogAxis::of(xs), y = hbLogAxis::of(ys);

  std::string data, curves;
  int count = 0;
  for (const Series& one : series) {
    if (one.points.empty()) continue;
    data += fmt::format("$series{} << END\n", count);
    for (const auto& point : one.points)
      data += fmt::format("{} {}\n", logX ? x.place(point.first) : point.first, y.place(point.second));
    data += "END\n";
    curves +=
        fmt::format("{}$series{} using 1:2 {} title {}", count > 0 ? ", " : "", count, style(one), quoted(one.title));
    ++count;
  }
  if (count == 0) throw hbError(fmt::format("plot \"{}\": expected at least one point, found none", title));

  const int rows = (count + kLegendColumns - 1) / kLegendColumns;
  const std::string script =
      fmt::format("set terminal svg size {},{} font 'sans-serif,13' noenhanced background '#ffffff'\n"
                  "set encoding utf8\n"
                  "set title {}\nset xlabel {} offset 0,1.2\nset ylabel {}\n"
                  "set border 3 lc rgb '#555555'\nset tics nomirror out scale 0.5 textcolor rgb '#222222'\n"
                  "set grid xtics ytics lc rgb '#dddddd' lt 1 lw 1\n"
                  "set xtics offset 0,0.5\n"
                  "set key outside below center horizontal Left reverse samplen 2.5 height 0.8 maxcols {} textcolor "
                  "rgb '#222222'\n",
                  kWidth, kHeight + kLegendRow * rows, quoted(title), quoted(xLabel), quoted(yLabel), kLegendColumns) +
      (logX ? logarithmic('x', x) : integral('x', xs)) + logarithmic('y', y) + data + "plot " + curves + "\n";
  return gnuplot.output({"--default-settings", "-"}, script, progress);
}

hbExternalProgram hbPlot::findGnuplot() {
  if (const auto gnuplot = hbExternalProgram::find("gnuplot")) return *gnuplot;
  throw hbError("gnuplot: expected the program in PATH (Debian's package gnuplot-nox), found none");
}
