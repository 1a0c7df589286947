#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "report/hbErrorStatistics.h"
#include "report/hbMachine.h"
#include "report/hbPictureDifference.h"

/// How what was measured is written into reports.
namespace hb {

using ReportJson = nlohmann::ordered_json;

/// JSON has no infinity and no NaN: they become null.
ReportJson finiteOrNull(double value);
/// The value, or null.
ReportJson numberOrNull(const std::optional<double>& value);

/// JSON as text; bytes that are no UTF-8 are replaced. `indent` < 0: on one line.
std::string jsonText(const ReportJson& json, int indent = -1);
/// What is read again of that text: what files keep of it.
ReportJson storedJson(const ReportJson& json);

/// {"max", "rmse", "psnr", "points"}; `peak`: of the PSNR, which is null where nothing differs or there is no peak.
ReportJson reportJson(const hbErrorStatistics& errors, double peak);
/// {"max", "rmse", "psnr", "ssim", "luv_mean", "luv_max"}
ReportJson reportJson(const hbPictureDifference& errors);
/// {"processor", "cores", ...}
ReportJson reportJson(const hbMachine& machine);

} // namespace hb
