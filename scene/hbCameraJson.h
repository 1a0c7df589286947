#pragma once

#include <string>

#include "scene/hbCamera.h"
#include "scene/hbJsonReader.h"

/// Cameras in JSON, as scenes and paths have them. Not installed: it shows nlohmann-json, which is private to the
/// library.
namespace hb {

nlohmann::ordered_json vectorToJson(const glm::dvec3& v);
nlohmann::ordered_json cameraToJson(const hbCamera& camera);

/// Throws hbError beginning with `place` for anything but an object of the right keys and types; its numbers are not
/// looked at.
hbCamera cameraFromJson(const nlohmann::json& json, const std::string& place);

} // namespace hb
