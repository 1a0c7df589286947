#include "report/hbReportJson.h"

#include <cmath>

hb::ReportJson hb::finiteOrNull(double value) { return std::isfinite(value) ? ReportJson(value) : ReportJson(); }

hb::ReportJson hb::numberOrNull(const std::optional<double>& value) {
  return value ? finiteOrNull(*value) : ReportJson();
}

std::string hb::jsonText(const ReportJson& json, int indent) {
  return json.dump(indent, ' ', false, ReportJson::error_handler_t::replace);
}

hb::ReportJson hb::storedJson(const ReportJson& json) { return ReportJson::parse(jsonText(json)); }

hb::ReportJson hb::reportJson(const hbErrorStatistics& errors, double peak) {
  return {{"max", finiteOrNull(errors.max)},
          {"rmse", finiteOrNull(errors.rmse())},
          {"psnr", peak > 0.0 ? numberOrNull(errors.psnr(peak)) : ReportJson()},
          {"points", errors.count}};
}

hb::ReportJson hb::reportJson(const hbPictureDifference& errors) {
  return {{"max", finiteOrNull(errors.max)},          {"rmse", finiteOrNull(errors.rmse)},
          {"psnr", numberOrNull(errors.psnr)},        {"ssim", numberOrNull(errors.ssim)},
          {"luv_mean", finiteOrNull(errors.luvMean)}, {"luv_max", finiteOrNull(errors.luvMax)}};
}

hb::ReportJson hb::reportJson(const hbMachine& machine) {
  return {{"processor", machine.processor},      {"cores", machine.cores},
          {"memory_bytes", machine.memoryBytes}, {"system", machine.system},
          {"compiler", machine.compiler},        {"instruction_set", machine.instructionSet}};
}
