#pragma once

#include "report/hbHardCaseResults.h"
#include "report/hbReportJson.h"

namespace hb {

/// One of "cases" in the key "hard_cases" of report.json: {"name", "why", "amplification" (sum of the coefficients'
/// magnitudes), "range", "hierarchical_terms", "combination_terms", "results": [{"engine", "format" ("" where there is
/// no choice), "error", "error_of_range" (in parts of the range), "bound", "share" (these four null unless done and
/// finite), "within_bound" (and the bound is less than the range), "exceeds_bound", "says_nothing" (the bound is the
/// range or more), "stable", "status" ("done", "refused", "failed"), "note"}], "most_stable" (engine and format as one
/// word, "none" where all were refused), "reason"}.
ReportJson toJson(const hbHardCaseResults& one);

} // namespace hb
