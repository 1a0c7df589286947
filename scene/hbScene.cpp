#include "scene/hbScene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scene/hbColormap.h"
#include "scene/hbJsonReader.h"
#include "scene/hbTextFile.h"
#include "scene/hbTransferFunctionFile.h"
#include "volume/hbError.h"

using Json = nlohmann::json;

namespace {

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;

// The names in JSON, in the order of the enumerators.
constexpr std::array<std::string_view, 2> kProjections{"orthographic", "perspective"};
constexpr std::array<std::string_view, 2> kSamplingKinds{"equidistant", "planewise"};

hbCamera cameraFromJson(const Json& json, const std::string& place) {
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

hbSampling samplingFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"kind", "samples"});
  hbSampling sampling;
  reader.read("kind", sampling.kind, kSamplingKinds);
  reader.read("samples", sampling.samples);
  return sampling;
}

} // namespace

hbCamera hbScene::cameraFor(const hbGeometry& geometry) const {
  return camera ? *camera
                : hbCamera::framing(geometry, hbCamera::kDefaultAzimuth, hbCamera::kDefaultElevation,
                                    hbCamera::Projection::perspective, double(width) / height);
}

void hbScene::validate(const std::string& what) const {
  const auto within = [&](const char* name, int value, int lo, int hi) {
    if (value < lo || value > hi)
      throw hbError(fmt::format("{}: {}: expected {} to {}, found {}", what, name, lo, hi, value));
  };
  within("width", width, 1, kMaxPictureSide);
  within("height", height, 1, kMaxPictureSide);
  within("component", component, 0, std::numeric_limits<int>::max());
  within("sampling: samples", sampling.samples, 0, hbSampling::kMaxSamples);
  if (camera) camera->validate(what + ": camera");
  if (isoValue && !std::isfinite(*isoValue))
    throw hbError(fmt::format("{}: isoValue: expected a finite number, found {}", what, *isoValue));
  if (window && !(std::isfinite(window->first) && std::isfinite(window->second) && window->first < window->second))
    throw hbError(fmt::format("{}: window: expected two finite numbers, the first less than the second, found {}, {}",
                              what, window->first, window->second));
  if (background)
    for (int c = 0; c < 3; ++c)
      if (!((*background)[c] >= 0.0 && (*background)[c] <= 1.0))
        throw hbError(fmt::format("{}: background: expected channels in [0,1], found {}", what, (*background)[c]));
  const auto maps = hbColormap::names();
  if (!colormap.empty() && std::find(maps.begin(), maps.end(), colormap) == maps.end())
    throw hbError(fmt::format("{}: colormap: expected one of {}, found '{}'", what, fmt::join(maps, ", "),
                              hb::excerpt(colormap)));
}

std::string hb::toJson(const hbScene& scene) {
  scene.validate();
  const auto vector = [](const glm::dvec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  nlohmann::ordered_json json;
  json["version"] = kVersion;
  json["mode"] = modeName(scene.mode);
  if (const auto& camera = scene.camera)
    json["camera"] = {{"projection", kProjections[std::size_t(camera->projection)]},
                      {"position", vector(camera->position)},
                      {"target", vector(camera->target)},
                      {"up", vector(camera->up)},
                      {"fieldOfView", camera->fieldOfView},
                      {"height", camera->height}};
  json["sampling"] = {{"kind", kSamplingKinds[std::size_t(scene.sampling.kind)]}, {"samples", scene.sampling.samples}};
  if (scene.isoValue) json["isoValue"] = *scene.isoValue;
  if (scene.window) json["window"] = {scene.window->first, scene.window->second};
  if (!scene.colormap.empty()) json["colormap"] = scene.colormap;
  if (scene.transfer) json["transfer"] = nlohmann::ordered_json::parse(toJson({&*scene.transfer, 1}))[0];
  if (scene.preintegrated) json["preintegrated"] = true;
  if (scene.background) json["background"] = vector(*scene.background);
  json["component"] = scene.component;
  json["magnitude"] = scene.magnitude;
  json["width"] = scene.width;
  json["height"] = scene.height;
  return json.dump(2) + "\n";
}

hbScene hb::sceneFromJson(const std::string& text, const std::string& name) {
  const Json json = hb::parseJson(text, name);
  const hbJsonReader reader(json, name,
                            {"version", "mode", "camera", "sampling", "isoValue", "window", "colormap", "transfer",
                             "preintegrated", "background", "component", "magnitude", "width", "height"});
  int version = 0;
  reader.require("version");
  reader.read("version", version);
  if (version != kVersion) throw reader.wrong("version", fmt::format("{}", kVersion), *reader.find("version"));

  hbScene scene;
  std::string mode(modeName(scene.mode));
  reader.read("mode", mode);
  if (mode != "xray" && mode != "mip" && mode != "iso" && mode != "dvr")
    throw reader.wrong("mode", "xray, mip, iso or dvr", *reader.find("mode"));
  scene.mode = modeFromName(mode);
  if (const Json* camera = reader.find("camera")) scene.camera = cameraFromJson(*camera, name + ": camera");
  if (const Json* sampling = reader.find("sampling")) scene.sampling = samplingFromJson(*sampling, name + ": sampling");
  if (const Json* value = reader.find("isoValue")) scene.isoValue = reader.number("isoValue", *value);
  if (const Json* window = reader.find("window")) {
    if (!window->is_array() || window->size() != 2) throw reader.wrong("window", "an array of 2 numbers", *window);
    scene.window.emplace(reader.number("window", (*window)[0]), reader.number("window", (*window)[1]));
  }
  reader.read("colormap", scene.colormap);
  if (const Json* transfer = reader.find("transfer")) {
    if (!transfer->is_object()) throw reader.wrong("transfer", "an object", *transfer);
    scene.transfer = transferFunctionsFromJson(transfer->dump(), name + ": transfer").front();
  }
  reader.read("preintegrated", scene.preintegrated);
  if (reader.find("background") != nullptr) reader.read("background", scene.background.emplace());
  reader.read("component", scene.component);
  reader.read("magnitude", scene.magnitude);
  reader.read("width", scene.width);
  reader.read("height", scene.height);
  scene.validate(name);
  return scene;
}

hbScene hb::loadScene(const std::filesystem::path& path) {
  return sceneFromJson(loadText(path, kMaxFileBytes, "a scene"), path.string());
}

void hb::saveScene(const hbScene& scene, const std::filesystem::path& path) { saveText(toJson(scene), path); }
