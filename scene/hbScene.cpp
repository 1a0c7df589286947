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

#include "scene/hbCameraJson.h"
#include "scene/hbColormap.h"
#include "scene/hbJsonReader.h"
#include "scene/hbTransferFunctionFile.h"
#include "volume/hbError.h"
#include "volume/hbTextFile.h"

using Json = nlohmann::json;
using hb::vectorToJson;

namespace {

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;

// The names in JSON, in the order of the enumerators.
constexpr std::array<std::string_view, 2> kSamplingKinds{"equidistant", "planewise"};

hbSampling samplingFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"kind", "samples"});
  hbSampling sampling;
  reader.read("kind", sampling.kind, kSamplingKinds);
  reader.read("samples", sampling.samples);
  return sampling;
}

hbShading shadingFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"ambient", "diffuse", "specular", "shininess", "lights"});
  hbShading shading;
  reader.read("ambient", shading.ambient);
  reader.read("diffuse", shading.diffuse);
  reader.read("specular", shading.specular);
  reader.read("shininess", shading.shininess);
  const Json* lights = reader.find("lights");
  if (lights == nullptr) return shading;
  if (!lights->is_array() || lights->size() > hbShading::kMostLights)
    throw reader.wrong("lights", fmt::format("an array of at most {} objects", hbShading::kMostLights), *lights);
  for (const Json& one : *lights) {
    const hbJsonReader light(one, place + ": lights", {"position", "color"});
    light.require("position");
    light.read("position", shading.lights.emplace_back().position);
    light.read("color", shading.lights.back().colour);
  }
  return shading;
}

nlohmann::ordered_json shadingToJson(const hbShading& shading) {
  nlohmann::ordered_json json{{"ambient", shading.ambient},
                              {"diffuse", shading.diffuse},
                              {"specular", shading.specular},
                              {"shininess", shading.shininess}};
  for (const hbShading::Light& light : shading.lights)
    json["lights"].push_back({{"position", vectorToJson(light.position)}, {"color", vectorToJson(light.colour)}});
  return json;
}

hbScene::ClipBox clipFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"lo", "hi"});
  hbScene::ClipBox box;
  reader.read("lo", box.lo);
  reader.read("hi", box.hi);
  return box;
}

hbScene::Plane planeFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place, {"point", "normal"});
  hbScene::Plane plane;
  reader.require("point");
  reader.require("normal");
  reader.read("point", plane.point);
  reader.read("normal", plane.normal);
  return plane;
}

std::optional<std::pair<double, double>> pairFromJson(const hbJsonReader& reader, const char* key) {
  const Json* pair = reader.find(key);
  if (pair == nullptr) return std::nullopt;
  if (!pair->is_array() || pair->size() != 2) throw reader.wrong(key, "an array of 2 numbers", *pair);
  return std::pair(reader.number(key, (*pair)[0]), reader.number(key, (*pair)[1]));
}

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

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
  if (shading) shading->validate(what + ": shading");
  if (labels && preintegrated)
    throw hbError(what + ": preintegrated: expected false for labels, between which there is nothing to integrate");
  if (gradientOpacity && !(gradientOpacity->first >= 0.0 && gradientOpacity->first < gradientOpacity->second &&
                           std::isfinite(gradientOpacity->second)))
    throw hbError(
        fmt::format("{}: gradientOpacity: expected two numbers from 0 on, the first less than the second, found {}, {}",
                    what, gradientOpacity->first, gradientOpacity->second));
  if (clip)
    for (int d = 0; d < 3; ++d)
      if (!(clip->lo[d] >= 0.0 && clip->lo[d] < clip->hi[d] && clip->hi[d] <= 1.0))
        throw hbError(fmt::format("{}: clip: expected a box of some size within 0 to 1, found {} to {} along axis {}",
                                  what, clip->lo[d], clip->hi[d], "xyz"[d]));
  if (slice && !(isFinite(slice->point) && isFinite(slice->normal) && slice->normal != glm::dvec3(0.0)))
    throw hbError(what + ": slice: expected a finite point and a finite normal other than 0");
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
  nlohmann::ordered_json json;
  json["version"] = kVersion;
  json["mode"] = modeName(scene.mode);
  if (scene.camera) json["camera"] = cameraToJson(*scene.camera);
  json["sampling"] = {{"kind", kSamplingKinds[std::size_t(scene.sampling.kind)]}, {"samples", scene.sampling.samples}};
  if (scene.isoValue) json["isoValue"] = *scene.isoValue;
  if (scene.window) json["window"] = {scene.window->first, scene.window->second};
  if (!scene.colormap.empty()) json["colormap"] = scene.colormap;
  if (scene.transfer) json["transfer"] = nlohmann::ordered_json::parse(toJson({&*scene.transfer, 1}))[0];
  if (scene.preintegrated) json["preintegrated"] = true;
  if (scene.shading) json["shading"] = shadingToJson(*scene.shading);
  if (scene.gradientOpacity) json["gradientOpacity"] = {scene.gradientOpacity->first, scene.gradientOpacity->second};
  if (scene.clip) json["clip"] = {{"lo", vectorToJson(scene.clip->lo)}, {"hi", vectorToJson(scene.clip->hi)}};
  if (scene.slice)
    json["slice"] = {{"point", vectorToJson(scene.slice->point)}, {"normal", vectorToJson(scene.slice->normal)}};
  if (scene.background) json["background"] = vectorToJson(*scene.background);
  if (scene.labels) json["labels"] = true;
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
                             "preintegrated", "shading", "gradientOpacity", "clip", "slice", "background", "labels",
                             "component", "magnitude", "width", "height"});
  int version = 0;
  reader.require("version");
  reader.read("version", version);
  if (version != kVersion) throw reader.wrong("version", fmt::format("{}", kVersion), *reader.find("version"));

  hbScene scene;
  std::string mode(modeName(scene.mode));
  reader.read("mode", mode);
  if (mode != "xray" && mode != "mip" && mode != "iso" && mode != "dvr" && mode != "slice")
    throw reader.wrong("mode", "xray, mip, iso, dvr or slice", *reader.find("mode"));
  scene.mode = modeFromName(mode);
  if (const Json* camera = reader.find("camera")) scene.camera = cameraFromJson(*camera, name + ": camera");
  if (const Json* sampling = reader.find("sampling")) scene.sampling = samplingFromJson(*sampling, name + ": sampling");
  if (const Json* value = reader.find("isoValue")) scene.isoValue = reader.number("isoValue", *value);
  scene.window = pairFromJson(reader, "window");
  reader.read("colormap", scene.colormap);
  if (const Json* transfer = reader.find("transfer")) {
    if (!transfer->is_object()) throw reader.wrong("transfer", "an object", *transfer);
    scene.transfer = transferFunctionsFromJson(transfer->dump(), name + ": transfer").front();
  }
  reader.read("preintegrated", scene.preintegrated);
  if (const Json* shading = reader.find("shading")) scene.shading = shadingFromJson(*shading, name + ": shading");
  scene.gradientOpacity = pairFromJson(reader, "gradientOpacity");
  if (const Json* clip = reader.find("clip")) scene.clip = clipFromJson(*clip, name + ": clip");
  if (const Json* slice = reader.find("slice")) scene.slice = planeFromJson(*slice, name + ": slice");
  if (reader.find("background") != nullptr) reader.read("background", scene.background.emplace());
  reader.read("labels", scene.labels);
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
