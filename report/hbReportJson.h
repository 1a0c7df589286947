#pragma once

#include <optional>

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

/// {"max", "rmse", "psnr"}; psnr is null where nothing differs.
ReportJson reportJson(const hbErrorStatistics& errors);
/// {"max", "rmse", "psnr", "ssim", "luv_mean", "luv_max"}
ReportJson reportJson(const hbPictureDifference& errors);
/// {"processor", "cores", ...}
ReportJson reportJson(const hbMachine& machine);

} // namespace hb
