#include "report/hbFitJson.h"

hb::ReportJson hb::provenanceOf(const hbFitReport& report) {
  const bool robust = report.loss.kind != hbFitLoss::Kind::none, smooth = report.method == "least-squares";
  return {{"method", report.method},
          {"solver", report.solver},
          {"loss", report.loss.name()},
          {"loss_threshold", robust ? ReportJson(report.loss.threshold) : ReportJson()},
          {"smoothing", smooth ? ReportJson(report.smoothing) : ReportJson()},
          {"held_out_rmse", hb::finiteOrNull(report.heldOutErrors.rmse)},
          {"interpolation_held_out_rmse", hb::finiteOrNull(report.interpolationHeldOutErrors.rmse)},
          {"converged", report.converged},
          {"interrupted", report.interrupted},
          {"improved", report.improved}};
}

hb::ReportJson hb::toJson(const hbFitReport& report) {
  ReportJson json = provenanceOf(report);
  json["samples"] = report.samples;
  json["held_out"] = report.heldOut;
  json["unknowns"] = report.unknowns;
  json["iterations"] = report.iterations;
  json["rounds"] = report.rounds;
  json["condition_estimate"] = hb::finiteOrNull(report.condition);
  json["residual_rmse"] = hb::finiteOrNull(report.fitted.rmse);
  json["interpolation_residual_rmse"] = hb::finiteOrNull(report.interpolationFitted.rmse);
  json["held_out_cost"] = hb::finiteOrNull(report.heldOutErrors.cost);
  json["interpolation_held_out_cost"] = hb::finiteOrNull(report.interpolationHeldOutErrors.cost);
  json["seconds"] = report.seconds;
  return json;
}
