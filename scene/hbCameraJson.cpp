#include "scene/hbCameraJson.h"

#include <array>

namespace {

// The names in JSON, in the order of the enumerators.
constexpr std::array<std::string_view, 2> kProjections{"orthographic", "perspective"};

} // namespace

nlohmann::ordered_json hb::vectorToJson(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json hb::cameraToJson(const hbCamera& camera) {
  return {{"projection", kProjections[std::size_t(camera.projection)]},
          {"position", vectorToJson(camera.position)},
          {"target", vectorToJson(camera.target)},
          {"up", vectorToJson(camera.up)},
          {"fieldOfView", camera.fieldOfView},
          {"height", camera.height}};
}

hbCamera hb::cameraFromJson(const nlohmann::json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"projection", "position", "target", "up", "fieldOfView", "height"});
  hbCamera camera;
  reader.require("position");
  reader.require("target");
  reader.read("projection", camera.projection, kProjections);
  if (camera.projection == hbCamera::Projection::orthographic) reader.require("height");
  reader.read("position", camera.position);
  reader.read("target", camera.target);
  reader.read("up", camera.up);
  reader.read("fieldOfView", camera.fieldOfView);
  reader.read("height", camera.height);
  return camera;
}
