#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/hbExternalProgram.h"
#include "volume/hbProgress.h"

/// A plot of series of points, drawn by gnuplot.
struct hbPlot {
  enum class Line { none, solid, dashed, dotted };
  struct Series {
    std::string title;                               ///< In the legend.
    std::string color;                               ///< "#rrggbb"
    Line line = Line::solid;                         ///< Between the points, in their order.
    int point = 0;                                   ///< gnuplot's point type; 0: none.
    double width = 1.5;                              ///< Of the line, in pixels.
    std::vector<std::pair<double, double>> points{}; ///< Finite; empty series are left out.
  };

  std::string title, xLabel, yLabel;
  bool logX = true; ///< Otherwise x are small integers (levels), each of which gets a tick. y is always logarithmic.
  std::vector<Series> series; ///< Later ones are drawn over earlier ones. Zeros on a logarithmic axis lie at its "0".

  bool empty() const;

  /// The plot as SVG, some 600 pixels wide, the legend below: the same bytes for the same plot and gnuplot. Throws
  /// hbError where gnuplot fails, hbCancelled when cancelled.
  std::string svg(const hbExternalProgram& gnuplot, hbProgress& progress = hbProgress::none()) const;

  /// gnuplot, from PATH. Throws hbError where there is none.
  static hbExternalProgram findGnuplot();
};
