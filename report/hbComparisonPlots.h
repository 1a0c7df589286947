#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "volume/hbProgress.h"

/// A comparison's report in plots.
namespace hb {

/// Draws the report's plots as SVG into folder/plots, which is made, and notes them as paths relative to the folder:
///
///     "plots": {"error_time":  {"xray": "plots/error-time-xray.svg", ...},   picture RMSE over seconds a frame
///               "error_bytes": {...},                                        picture RMSE over compressed bytes
///               "time_level":  {...},                                        seconds a frame over level
///               "convergence": {"values": ..., "true_values": ...}}          RMSE of values over level
///
/// Plots with nothing to show are left out, and those over the level where there is only one. Cases whose pictures
/// were compared as images of bytes ("image_only") have no place in plots of picture errors. Pareto fronts are drawn
/// through the cases that the report marks. The same report and gnuplot give the same bytes. Throws hbError where
/// gnuplot is missing or fails or a file cannot be written (the report is then as before), hbCancelled when cancelled.
void makeComparisonPlots(nlohmann::ordered_json& report, const std::filesystem::path& folder,
                         hbProgress& progress = hbProgress::none());

} // namespace hb
