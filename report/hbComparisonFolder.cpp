#include "report/hbComparisonFolder.h"

#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "report/hbReportJson.h"
#include "volume/hbError.h"
#include "volume/hbOutputFile.h"

namespace fs = std::filesystem;

namespace {

using Json = hbComparisonFolder::Json;

constexpr const char* kHead = "comparison.json";
constexpr const char* kMadeBy = "hbvol compare";
constexpr const char* kParts[] = {"records", "choices", "pictures"};

/// What a file holds; none where it is missing or no JSON.
std::optional<Json> readJson(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  Json json = Json::parse(stream, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

/// The first member that differs, and how.
std::string difference(const Json& old, const Json& now) {
  for (const auto& [key, value] : now.items())
    if (const Json before = old.value(key, Json()); before != value)
      return fmt::format("{} {}, found {}", key, hb::jsonText(before), hb::jsonText(value));
  for (const auto& [key, value] : old.items())
    if (!now.contains(key)) return fmt::format("{} {}, found none", key, hb::jsonText(value));
  return "the same settings";
}

} // namespace

void hb::writeJson(const nlohmann::ordered_json& json, const fs::path& file) {
  hbOutputFile out(file);
  std::ofstream stream(out.path(), std::ios::binary);
  stream << hb::jsonText(json, 2) << '\n';
  stream.close();
  if (!stream) throw hbError(fmt::format("{}: cannot be written", file.string()));
  out.commit();
}

hbComparisonFolder::hbComparisonFolder(const fs::path& path, const Json& settings, bool restart) : path_(path) {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error))
    throw hbError(fmt::format("{}: expected a folder, found a file", path_.string()));
  fs::create_directories(path_, error);
  if (error) throw hbError(fmt::format("{}: cannot be made: {}", path_.string(), error.message()));
  lock_.emplace(path_);
  const Json now = hb::storedJson(settings);
  const std::optional<Json> known = readJson(path_ / kHead);
  const bool isOurs = known && known->is_object() && known->value("made_by", "") == kMadeBy;
  if (!isOurs && !fs::is_empty(path_))
    throw hbError(
        fmt::format("{}: expected an empty folder or one of a comparison, found other files", path_.string()));
  if (!isOurs || restart) {
    begin(now, isOurs);
    return;
  }
  if ((*known)["settings"] != now)
    throw hbError(fmt::format("{}: holds another comparison: expected {}; give another folder, or --restart",
                              path_.string(), difference((*known)["settings"], now)));
  head_ = *known;
  runs_ = head_.value("runs", 0);
  for (const char* part : kParts) fs::create_directories(path_ / part);
}

void hbComparisonFolder::begin(const Json& settings, bool isOld) {
  std::error_code error;
  if (isOld)
    for (const char* part : kParts) { // what an old comparison left would be taken for this one's
      fs::remove_all(path_ / part, error);
      if (error) throw hbError(fmt::format("{}: cannot be removed: {}", (path_ / part).string(), error.message()));
    }
  head_ = Json{{"made_by", kMadeBy}, {"settings", settings}, {"runs", 0}};
  writeHead();
  for (const char* part : kParts) {
    fs::create_directories(path_ / part, error);
    if (error) throw hbError(fmt::format("{}: cannot be made: {}", (path_ / part).string(), error.message()));
  }
}

void hbComparisonFolder::writeHead() const { hb::writeJson(head_, path_ / kHead); }

std::optional<Json> hbComparisonFolder::find(const std::string& key) const {
  std::optional<Json> record = readJson(path_ / "records" / (key + ".json"));
  if (!record || !record->is_object()) return std::nullopt;
  for (const char* file : {"file", "image", "difference"})
    if (const Json name = record->value(file, Json()); name.is_string() && !fs::exists(path_ / name.get<std::string>()))
      return std::nullopt;
  return record;
}

Json hbComparisonFolder::keep(const std::string& key, Json record) {
  if (!hasMeasured_) {
    hasMeasured_ = true;
    head_["runs"] = ++runs_;
    writeHead();
  }
  record["run"] = runs_;
  record = hb::storedJson(record);
  hb::writeJson(record, path_ / "records" / (key + ".json"));
  return record;
}
