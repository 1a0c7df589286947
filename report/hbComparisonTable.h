#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

/// A comparison's report as a table for spreadsheets and scripts.
namespace hb {

/// The report's cases as CSV after RFC 4180 (lines end in CR LF): a header, then a row a case, in the report's order.
///
/// The columns are all keys of the cases, and "choice_" with all keys of their choices; nested keys are joined by "_"
/// ("seconds_frame_median", "choice_size_0"). Numbers have all their digits and a point whatever the locale, null is
/// empty, truth is "true" or "false".
std::string comparisonTable(const nlohmann::ordered_json& report);

/// The same as a file, whole or not at all. Throws hbError where it cannot be written.
void writeComparisonTable(const nlohmann::ordered_json& report, const std::filesystem::path& path);

} // namespace hb
