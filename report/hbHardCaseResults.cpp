#include "report/hbHardCaseResults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "glcombine/hbGlContext.h"
#include "report/hbHardCaseMeasurement.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "volume/hbError.h"

namespace {

using Status = hbHardCaseResult::Status;

hbHardCaseResult failure(const hbHardCaseWay& way, Status status, const std::string& note) {
  hbHardCaseResult result;
  result.way = way;
  result.status = status;
  result.note = note;
  return result;
}

hbHardCaseResult tried(const hbHardCaseMeasurement& measurement, const hbHardCaseWay& way, const hbGlContext* context,
                       const std::string& whyNone) {
  if (way.isOpenGl() && !context) return failure(way, Status::refused, whyNone);
  try {
    return hbHardCaseResult::of(way, measurement.errors(way, context), measurement.range());
  } catch (const hbCancelled&) {
    throw;
  } catch (const hbError& error) {
    return failure(way, Status::refused, error.what());
  } catch (const std::exception& error) {
    return failure(way, Status::failed, error.what());
  }
}

} // namespace

hbHardCaseResult hbHardCaseResult::of(const hbHardCaseWay& way, const std::vector<hbHardCaseError>& errors,
                                      double range) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto finiteOrInfinite = [](double value) { return std::isfinite(value) ? value : kInfinity; };
  hbHardCaseResult result;
  result.way = way;
  for (const hbHardCaseError& one : errors) {
    result.error = std::max(result.error, finiteOrInfinite(one.error));
    result.bound = std::max(result.bound, finiteOrInfinite(one.bound));
    // A comparison with NaN is false, and an infinite bound is none.
    const bool isComparable = std::isfinite(one.bound) && !std::isnan(one.error);
    if (!isComparable)
      result.share = kInfinity;
    else if (one.error > 0.0)
      result.share = std::max(result.share, one.error / one.bound);
  }
  result.stable = result.error <= kStable * range;
  result.saysNothing = !(result.bound < range);
  return result;
}

const hbHardCaseResult* hbHardCaseResults::mostStable() const {
  const hbHardCaseResult* best = nullptr;
  for (const hbHardCaseResult& one : results) {
    if (one.status != Status::done || one.way.engine == hbHardCaseWay::Engine::stored) continue;
    if (!best || one.error < best->error) best = &one;
  }
  return best;
}

std::string hbHardCaseResults::reason() const {
  const hbHardCaseResult* best = mostStable();
  if (!best) return "no way took it";
  const auto count = [&](auto test) { return std::count_if(results.begin(), results.end(), test); };
  const auto isFloat = [](const hbHardCaseResult& one) {
    return one.status == Status::done && one.way.engine != hbHardCaseWay::Engine::stored &&
           one.way.format == hbGlFormat::r32f;
  };
  const auto floats = count(isFloat), stable = count([&](const auto&one) { return isFloat(one) && one.stable; });
  return fmt::format("terms at a point add up to {:.3g} times the range in the hierarchical basis, to {:.3g} in the "
                     "combination; {} of {} ways in 32 bits lose no more than 4 bits of it",
                     hierarchicalTerms, combinationTerms, stable, floats);
}

hbHardCaseResult hb::measureHardCase(const hbHardCase::Problem& problem, const hbHardCaseWay& way,
                                     const hbGlContext* context) {
  return tried(*hbHardCaseMeasurement::of(problem), way, context, "OpenGL: expected a context, found none");
}

/// A context, current as long as this lives, or why there is none.
class hbHardCaseRun::Device {
public:
  Device() {
    try {
      context_ = hbGlContext::create();
      current_.emplace(*context_);
    } catch (const hbError& error) {
      why_ = error.what();
    }
  }
  const hbGlContext* context() const { return current_ ? context_.get() : nullptr; }
  const std::string& why() const { return why_; }

private:
  std::unique_ptr<hbGlContext> context_;
  std::optional<hbGlCurrent> current_;
  std::string why_;
};

hbHardCaseRun::hbHardCaseRun() : device_(std::make_unique<Device>()) {}
hbHardCaseRun::~hbHardCaseRun() = default;

void hbHardCaseRun::measure(const hbHardCase& one, hbHardCaseResults& results, hbProgress& progress) const {
  const hbHardCase::Problem problem = one.make();
  const auto measurement = hbHardCaseMeasurement::of(problem);
  const hbHardCaseMeasurement::Amplification terms = measurement->amplification();
  results.coefficients = hb::amplification(problem.grid.indexSet());
  results.range = measurement->range();
  results.hierarchicalTerms = terms.hierarchical;
  results.combinationTerms = terms.combination;
  for (const hbHardCaseWay& way : hbHardCaseWay::all()) {
    results.results.push_back(tried(*measurement, way, device_->context(), device_->why()));
    progress.advance(1);
  }
}

hbHardCaseResults hbHardCaseRun::of(const hbHardCase& one, hbProgress& progress) const {
  hbHardCaseResults results;
  results.name = one.name;
  results.why = one.why;
  try {
    measure(one, results, progress);
  } catch (const hbCancelled&) {
    throw;
  } catch (const std::exception& error) {
    for (const hbHardCaseWay& way : hbHardCaseWay::all())
      results.results.push_back(failure(way, Status::failed, error.what()));
    progress.advance(std::int64_t(results.results.size()));
  }
  return results;
}
