#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "report/hbFolderLock.h"

/// The folder of a comparison, which remembers what was measured already: an interrupted comparison goes on there.
///
/// comparison.json says what is compared; records/KEY.json is what was measured of a choice or a case; beside them lie
/// choices/ (compressed forms) and pictures/. Every file appears whole or not at all.
class hbComparisonFolder {
public:
  using Json = nlohmann::ordered_json;

  /// Opens the folder of the comparison that `settings` describes, or begins it: in a folder that is new or empty, or
  /// over an old comparison with `restart`. Throws hbError where the folder holds another comparison, naming what
  /// differs, or other files, or cannot be made, or where another process works in it.
  hbComparisonFolder(const std::filesystem::path& path, const Json& settings, bool restart);

  /// The record of that key, where it was kept and the files it names ("file", "image", "difference") are there.
  std::optional<Json> find(const std::string& key) const;
  /// Keeps a record (bytes that are no UTF-8 are replaced), and gives it back with the member "run", the number of this
  /// sitting.
  Json keep(const std::string& key, Json record);
  /// Sittings in which anything was measured, this one included.
  int runs() const { return runs_; }

  const std::filesystem::path& path() const { return path_; }
  /// Where the compressed form of a choice is kept.
  std::filesystem::path choice(const std::string& key) const { return path_ / "choices" / key; }
  /// The picture of a case: the name within the folder, as it stands in reports.
  static std::string picture(const std::string& key) { return "pictures/" + key + ".png"; }

private:
  void begin(const Json& settings, bool isOld);
  void writeHead() const;

  std::filesystem::path path_;
  std::optional<hbFolderLock> lock_;
  Json head_;
  int runs_ = 0;
  bool hasMeasured_ = false;
};

namespace hb {

/// Writes a JSON text, indented, with a line feed at its end; the file appears whole or not at all. Throws hbError.
void writeJson(const nlohmann::ordered_json& json, const std::filesystem::path& file);

} // namespace hb
