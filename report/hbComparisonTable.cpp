#include "report/hbComparisonTable.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "volume/hbTextFile.h"

namespace {

using Json = nlohmann::ordered_json;
using Row = std::map<std::string, std::string>; ///< The text of each column that is not empty.

class Columns {
public:
  /// Adds the values within `object` to the row, and their columns to the table.
  void add(const Json& object, const std::string& prefix, Row& row) {
    const Json flat = object.flatten();
    for (const auto& [pointer, value] : flat.items()) { // "/seconds_frame/median": 0.01
      std::string name = prefix + pointer.substr(1);
      std::replace(name.begin(), name.end(), '/', '_');
      if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
      if (!value.is_primitive() || value.is_null()) continue;
      row[name] = value.is_string() ? value.get<std::string>() : value.dump();
    }
  }

  /// The columns, but for those that hold nothing of their own because what is null in one row has parts in another.
  std::vector<std::string> names(const std::vector<Row>& rows) const {
    std::vector<std::string> kept;
    for (const std::string& name : names_)
      if (used(name, rows) || !hasParts(name)) kept.push_back(name);
    return kept;
  }

private:
  static bool used(const std::string& name, const std::vector<Row>& rows) {
    return std::any_of(rows.begin(), rows.end(), [&](const Row& row) { return row.contains(name); });
  }
  bool hasParts(const std::string& name) const {
    return std::any_of(names_.begin(), names_.end(),
                       [&](const std::string& other) { return other.starts_with(name + "_"); });
  }

  std::vector<std::string> names_;
};

std::string csvCell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string result(1, '"');
  for (const char c : text) result.append(c == '"' ? 2 : 1, c);
  result += '"';
  return result;
}

const Json* choiceOf(const Json& one, const Json& report) {
  for (const Json& choice : report.at("choices"))
    if (choice.at("key") == one.at("choice")) return &choice;
  return nullptr;
}

} // namespace

std::string hb::comparisonTable(const Json& report) {
  Columns columns;
  std::vector<Row> rows;
  for (const Json& one : report.at("cases")) {
    Row& row = rows.emplace_back();
    columns.add(one, "", row);
    if (const Json* choice = choiceOf(one, report)) columns.add(*choice, "choice_", row);
  }
  const std::vector<std::string> names = columns.names(rows);
  std::string text;
  const auto addLine = [&](const auto& cell) {
    for (std::size_t i = 0; i < names.size(); ++i) text.append(i > 0 ? "," : "").append(csvCell(cell(names[i])));
    text += "\r\n";
  };
  addLine([](const std::string& name) { return name; });
  for (const Row& row : rows)
    addLine([&](const std::string& name) {
      const auto at = row.find(name);
      return at == row.end() ? std::string() : at->second;
    });
  return text;
}

void hb::writeComparisonTable(const Json& report, const std::filesystem::path& path) {
  saveText(comparisonTable(report), path);
}
