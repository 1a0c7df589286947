#pragma once

#include <vector>

#include "report/hbHardCaseResults.h"
#include "report/hbReportJson.h"

namespace hb {

/// The key "hard_cases" of report.json: {"cases": [{"name", "why", "amplification" (sum of the coefficients'
/// magnitudes), "range", "hierarchical_terms", "combination_terms", "results": [{"engine", "format" ("" where there is
/// no choice), "error", "bound", "share" (null unless done), "within_bound", "stable", "status" ("done", "refused",
/// "failed"), "note"}], "most_stable" (engine and format as one word, "none" where all were refused), "reason"}]}.
ReportJson toJson(const std::vector<hbHardCaseResults>& cases);

} // namespace hb
