#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

/// A comparison's report for people.
namespace hb {

/// Writes folder/index.html: one page to be read from top to bottom, with everything in it (pictures and plots, which
/// are read from where the report says they are in the folder, styles; no scripts), and below 10 MB.
///
/// It is HTML5 and well-formed XML. Every figure and name out of the report is marked with the JSON pointer to its
/// place there, and no other figure stands in the text. Where the pictures of all choices are too large together, the
/// last ones and their differences are named instead of shown. Missing ones are named as well.
/// Throws hbError where one that is there cannot be read or the page not be written.
void writeComparisonPage(const nlohmann::ordered_json& report, const std::filesystem::path& folder);

} // namespace hb
