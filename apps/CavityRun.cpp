#include "apps/CavityRun.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/hbReportJson.h"
#include "volume/hbError.h"
#include "volume/hbRawFile.h"
#include "volume/hbVolumeStream.h"

namespace {

constexpr double kSeriesEnd = 20.0;

/// Opened before the work, so that what cannot be written is known at once.
hbVolumeStream open(const std::string& out, const hbCavityFlow& flow, hbCavityFlow::Quantity quantity) {
  return {out, flow.geometry(), hbSampleType::float32, 1, {std::string(hb::cavityQuantityName(quantity))}};
}

void write(hbVolumeStream& stream, const hbCavityFlow& flow, hbCavityFlow::Quantity quantity) {
  const std::vector<float> samples = flow.nodal(quantity);
  stream.write(std::as_bytes(std::span(samples)));
  stream.commit();
}

} // namespace

std::vector<std::string> app::seriesNames(const std::string& out, std::int64_t nodes, std::int64_t count) {
  const std::string raw = hb::rawFileName("", {nodes, nodes, nodes}, hbSampleType::float32);
  const std::string tail = out.ends_with(raw) ? raw : std::filesystem::path(out).extension().string();
  if (tail.empty()) throw hbError(fmt::format("{}: --steps expects a name such as stem.nrrd, found no extension", out));
  const std::string stem = out.substr(0, out.size() - tail.size());
  const std::size_t digits = std::max<std::size_t>(4, std::to_string(count - 1).size());
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < count; ++i) names.push_back(fmt::format("{}_{:0{}}{}", stem, i, digits, tail));
  return names;
}

void app::runCavity(const hbCavitySpecification& specification, std::int64_t nodes, std::int64_t steps,
                    const std::string& out, const CommonOptions& common) {
  const std::vector<std::string> files = steps > 0 ? seriesNames(out, nodes, steps) : std::vector{out};
  common.checkOutputs(files);
  const bool toSteady = steps == 0 && !specification.endTime;
  const double end = specification.endTime.value_or(kSeriesEnd);
  if (!toSteady) hbCavityFlow::checkTime(specification.flow, nodes, end);
  common.checkMemory(hbCavityFlow::memory(nodes, toSteady), out);
  const auto start = std::chrono::steady_clock::now();
  hbCavityFlow flow(specification.flow, nodes);
  for (std::size_t i = 0; i < files.size(); ++i) {
    hbVolumeStream stream = open(files[i], flow, specification.quantity);
    if (toSteady)
      flow.runToSteady(specification.tolerance, specification.maxSteps, progress());
    else
      flow.advanceTo(end * double(i + 1) / double(files.size()), progress());
    write(stream, flow, specification.quantity);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool steady = flow.residual() <= specification.tolerance;
  fmt::print(
      "{}{}: {} x {} x {} float32 samples of {} at Re={:g}, time {:.4g}, {} (changes by {:.2g} per unit of time), "
      "{} time steps, {:.1f} s\n",
      files.front(), steps > 1 ? " to " + files.back() : "", nodes, nodes, nodes,
      hb::cavityQuantityName(specification.quantity), specification.flow.reynolds, flow.time(),
      steady ? "steady" : "not steady", flow.residual(), flow.steps(), seconds);
  common.writeStats({{"samples", flow.geometry().samples() * std::int64_t(files.size())},
                     {"seconds", seconds},
                     {"specification", specification.text},
                     {"files", files},
                     {"steps", flow.steps()},
                     {"time", flow.time()},
                     {"residual", hb::finiteOrNull(flow.residual())},
                     {"steady", steady}});
}
