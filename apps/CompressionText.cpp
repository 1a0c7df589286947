#include "apps/CompressionText.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/Program.h"
#include "report/hbFitJson.h"
#include "report/hbReportJson.h"

namespace {

void print(const hbFitReport& fit, const std::string& component) {
  const bool robust = fit.loss.kind != hbFitLoss::Kind::none;
  const auto costs = [](const hbFitReport::Errors& errors) { return fmt::format(" (cost {:.4g})", errors.cost); };
  fmt::print("{}{} on {} samples held out: RMSE {:.6g}{}, interpolation {:.6g}{}{}\n", component, fit.method,
             fit.heldOut, fit.heldOutErrors.rmse, robust ? costs(fit.heldOutErrors) : "",
             fit.interpolationHeldOutErrors.rmse, robust ? costs(fit.interpolationHeldOutErrors) : "",
             fit.improved ? "" : "; no better, interpolation was kept");
  fmt::print("{}fitted to {} samples by {}, RMSE of all not held out {:.6g}", component, fit.samples, fit.solver,
             fit.fitted.rmse);
  if (robust) fmt::print(", {} from {:.3g} on", fit.loss.name(), fit.loss.threshold);
  if (fit.smoothing > 0.0) fmt::print(", smoothing {:.3g}", fit.smoothing);
  if (std::isfinite(fit.condition)) fmt::print(", condition about {:.3g}", fit.condition);
  fmt::print(", {} iterations{}, {:.2f} s\n", fit.iterations,
             fit.interrupted ? ", interrupted"
             : fit.converged ? ""
                             : ", not converged",
             fit.seconds);
}

} // namespace

nlohmann::ordered_json app::compressionStatistics(const hbSparseCompression::Result& result, std::uint64_t inputBytes,
                                                  std::uint64_t outputBytes) {
  const hbSparseGridFile& file = result.file;
  const hbSparseGrid& grid = file.grid;
  const std::int64_t samples = grid.geometry().samples();
  hb::ReportJson stats{{"representation", "sparse"},
                       {"level", grid.indexSet().number()},
                       {"input_bytes", inputBytes},
                       {"output_bytes", outputBytes},
                       {"samples", samples},
                       {"components", grid.components()},
                       {"stored_values", grid.indexSet().storedValues()},
                       {"bits_per_sample", 8.0 * double(outputBytes) / double(samples * grid.components())},
                       {"psnr", nullptr},
                       {"rmse", nullptr},
                       {"max_error", nullptr},
                       {"max_error_bound", nullptr}};
  for (const hbFitReport& fit : result.fits) stats["fit"].push_back(hb::toJson(fit));
  if (!file.error) return stats;
  // The worst component speaks for the file; `info --json` has them all.
  const auto& all = file.error->components;
  const auto worst =
      std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.psnr < b.psnr; });
  stats["psnr"] = hb::finiteOrNull(worst->psnr);
  stats["rmse"] = hb::finiteOrNull(worst->rmse);
  stats["max_error"] = hb::finiteOrNull(worst->max);
  return stats;
}

void app::printCompression(const std::string& out, const nlohmann::ordered_json& stats,
                           const hbSparseCompression::Result& result) {
  const hbSparseGridFile& file = result.file;
  fmt::print("{}: level {}, {} stored values for {} samples, {}, {:.4g} bits a sample\n", out,
             file.grid.indexSet().number(), file.grid.indexSet().storedValues(), file.grid.geometry().samples(),
             app::bytesText(stats["output_bytes"].get<double>()), stats["bits_per_sample"].get<double>());
  constexpr const char* kReferences[] = {"samples", "random samples", "random points of the field"};
  if (file.error)
    for (const auto& c : file.error->components)
      fmt::print("error against {} {}: max {:.6g}, RMSE {:.6g}, PSNR {}\n", c.points,
                 kReferences[std::size_t(c.reference)], c.max, c.rmse,
                 std::isnan(c.psnr) ? "n/a (one value only)" : fmt::format("{:.2f} dB", c.psnr));
  for (std::size_t c = 0; c < result.fits.size(); ++c)
    print(result.fits[c], result.fits.size() > 1 ? fmt::format("component {}: ", c) : std::string());
}
