#include "report/hbHardCaseJson.h"

#include <array>

namespace {

using Json = hb::ReportJson;

Json resultOf(const hbHardCaseResult& result, double range) {
  constexpr std::array<const char*, 3> kStatus{"done", "refused", "failed"};
  const bool isDone = result.status == hbHardCaseResult::Status::done;
  const auto number = [&](double value) { return isDone ? hb::finiteOrNull(value) : Json(); };
  return {{"engine", result.way.name()},
          {"format", result.way.formatName()},
          {"error", number(result.error)},
          {"error_of_range", number(result.error / range)},
          {"bound", number(result.bound)},
          {"share", number(result.share)},
          {"within_bound", result.isWithinBound()},
          {"exceeds_bound", result.exceedsBound()},
          {"says_nothing", isDone && result.saysNothing},
          {"stable", result.stable},
          {"status", kStatus[std::size_t(result.status)]},
          {"note", result.note}};
}

} // namespace

hb::ReportJson hb::toJson(const hbHardCaseResults& one) {
  Json results = Json::array();
  for (const hbHardCaseResult& result : one.results) results.push_back(resultOf(result, one.range));
  const hbHardCaseResult* best = one.mostStable();
  return {{"name", one.name},
          {"why", one.why},
          {"amplification", one.coefficients},
          {"range", one.range},
          {"hierarchical_terms", one.hierarchicalTerms},
          {"combination_terms", one.combinationTerms},
          {"results", std::move(results)},
          {"most_stable", best ? best->way.label() : "none"},
          {"reason", one.reason()}};
}
