#include "scene/hbCameraPath.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "scene/hbCameraJson.h"
#include "volume/hbTextFile.h"

namespace {

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{64} << 20;

/// About a unit axis (O. Rodrigues' formula).
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) +
         (1.0 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

} // namespace

std::vector<hbCamera> hb::orbit(const hbCamera& first, int count) {
  if (count < 1 || count > int(kMostCameras))
    throw hbError(fmt::format("orbit: expected 1 to {} pictures, found {}", kMostCameras, count));
  constexpr double kLevel = 1e-6;
  const glm::dvec3 up = glm::normalize(first.up);
  const glm::dvec3 axis = std::abs(up.z) > kLevel ? glm::dvec3(0.0, 0.0, 1.0) : up;
  std::vector<hbCamera> cameras(std::size_t(count), first);
  for (int i = 1; i < count; ++i) {
    hbCamera& camera = cameras[std::size_t(i)];
    const double angle = 2.0 * std::numbers::pi * i / count;
    camera.position = first.target + turned(first.position - first.target, axis, angle);
    camera.up = turned(first.up, axis, angle);
  }
  return cameras;
}

std::string hb::toJson(std::span<const hbCamera> cameras) {
  nlohmann::ordered_json json{{"version", kVersion}, {"cameras", nlohmann::ordered_json::array()}};
  for (const hbCamera& camera : cameras) {
    camera.validate();
    json["cameras"].push_back(cameraToJson(camera));
  }
  return json.dump(2) + "\n";
}

std::vector<hbCamera> hb::pathFromJson(const std::string& text, const std::string& name) {
  const nlohmann::json json = parseJson(text, name);
  const hbJsonReader reader(json, name, {"version", "cameras"});
  int version = 0;
  reader.require("version");
  reader.read("version", version);
  if (version != kVersion) throw reader.wrong("version", fmt::format("{}", kVersion), *reader.find("version"));
  reader.require("cameras");
  const nlohmann::json& list = *reader.find("cameras");
  if (!list.is_array() || list.empty() || list.size() > kMostCameras)
    throw reader.wrong("cameras", fmt::format("an array of 1 to {} objects", kMostCameras), list);
  std::vector<hbCamera> cameras;
  for (const nlohmann::json& one : list) {
    const std::string place = fmt::format("{}: cameras: {}", name, cameras.size());
    cameras.push_back(cameraFromJson(one, place));
    cameras.back().validate(place);
  }
  return cameras;
}

std::vector<hbCamera> hb::loadPath(const std::filesystem::path& path) {
  return pathFromJson(loadText(path, kMaxFileBytes, "a path of cameras"), path.string());
}

void hb::savePath(std::span<const hbCamera> cameras, const std::filesystem::path& path) {
  saveText(toJson(cameras), path);
}
