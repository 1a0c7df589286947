#include "report/hbHardCaseTable.h"

#include <fmt/format.h>

namespace {

std::string cellOf(const hbHardCaseResult& result, double range) {
  if (result.status != hbHardCaseResult::Status::done) return "-";
  const std::string bound = result.saysNothing ? "no statement" : fmt::format("{:.0e}", result.bound / range);
  const std::string text = fmt::format("{:.0e} / {}", result.error / range, bound);
  return result.stable ? "**" + text + "**" : text;
}

} // namespace

std::string hb::hardCaseTable(const std::vector<hbHardCaseResults>& cases) {
  std::string header = "| case | terms |", rule = "|---|---|";
  for (const hbHardCaseWay& way : hbHardCaseWay::all()) {
    header += fmt::format(" {} |", way.label());
    rule += "---|";
  }
  std::string table = header + " least error |\n" + rule + "---|\n";
  for (const hbHardCaseResults& one : cases) {
    table += fmt::format("| {} | {:.2g}, {:.2g} |", one.name, one.hierarchicalTerms, one.combinationTerms);
    for (const hbHardCaseResult& result : one.results) table += fmt::format(" {} |", cellOf(result, one.range));
    const hbHardCaseResult* best = one.mostStable();
    table += fmt::format(" {} |\n", best ? best->way.label() : "-");
  }
  return table;
}
