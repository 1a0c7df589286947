#include "report/hbComparisonFolder.h"

#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbOutputFile.h"

namespace fs = std::filesystem;

namespace {

using Json = hbComparisonFolder::Json;

constexpr const char* kHead = "comparison.json";
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
      return fmt::format("{} {}, found {}", key, before.dump(), value.dump());
  return "the same settings";
}

} // namespace

void hb::writeJson(const nlohmann::ordered_json& json, const fs::path& file) {
  hbOutputFile out(file);
  std::ofstream stream(out.path(), std::ios::binary);
  stream << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
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
  const std::optional<Json> known = readJson(path_ / kHead);
  if (!known || !known->contains("settings") || restart) {
    if (!known && !fs::is_empty(path_))
      throw hbError(
          fmt::format("{}: expected an empty folder or one of a comparison, found other files", path_.string()));
    begin(settings);
    return;
  }
  if ((*known)["settings"] != settings)
    throw hbError(fmt::format("{}: holds another comparison: expected {}; give another folder, or --restart",
                              path_.string(), difference((*known)["settings"], settings)));
  head_ = *known;
  runs_ = head_.value("runs", 0);
  for (const char* part : kParts) fs::create_directories(path_ / part);
}

void hbComparisonFolder::begin(const Json& settings) {
  std::error_code error;
  for (const char* part : kParts) {
    // What an old comparison left would be taken for this one's.
    fs::remove_all(path_ / part, error);
    if (!error) fs::create_directories(path_ / part, error);
    if (error) throw hbError(fmt::format("{}: cannot be made: {}", (path_ / part).string(), error.message()));
  }
  head_ = Json{{"settings", settings}, {"runs", 0}};
  writeHead();
}

void hbComparisonFolder::writeHead() const { hb::writeJson(head_, path_ / kHead); }

std::optional<Json> hbComparisonFolder::find(const std::string& key) const {
  return readJson(path_ / "records" / (key + ".json"));
}

Json hbComparisonFolder::keep(const std::string& key, Json record) {
  if (!hasMeasured_) {
    hasMeasured_ = true;
    head_["runs"] = ++runs_;
    writeHead();
  }
  record["run"] = runs_;
  hb::writeJson(record, path_ / "records" / (key + ".json"));
  return record;
}
