#include "scene/hbScene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "scene/hbColormap.h"
#include "volume/hbError.h"
#include "volume/hbMappedFile.h"
#include "volume/hbOutputFile.h"

using Json = nlohmann::json;

namespace {

constexpr int kVersion = 1;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;

// The names in JSON, in the order of the enumerators.
constexpr std::array<std::string_view, 2> kProjections{"orthographic", "perspective"};
constexpr std::array<std::string_view, 2> kSamplingKinds{"equidistant", "planewise"};

/// Text from outside for use in a message: printable ASCII and not long.
std::string excerpt(std::string_view text) {
  constexpr std::size_t kLength = 200;
  std::string result(text.substr(0, kLength));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return text.size() > kLength ? result + "..." : result;
}

std::string found(const Json& value) {
  return value.is_structured() ? value.is_array() ? "an array" : "an object"
                               : excerpt(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

/// Reads one JSON object whose keys are all known; every error names the place and the key.
class ObjectReader {
public:
  ObjectReader(const Json& object, std::string place, std::initializer_list<std::string_view> keys)
      : object_(object), place_(std::move(place)) {
    if (!object.is_object()) throw hbError(fmt::format("{}: expected an object, found {}", place_, found(object)));
    for (const auto& item : object.items())
      if (std::find(keys.begin(), keys.end(), item.key()) == keys.end())
        throw hbError(
            fmt::format("{}: {}: unknown key; known are {}", place_, excerpt(item.key()), fmt::join(keys, ", ")));
  }

  /// The value of a key, or nullptr.
  const Json* find(const char* key) const {
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }

  void require(const char* key) const {
    if (find(key) == nullptr) throw hbError(fmt::format("{}: {}: expected, but missing", place_, key));
  }

  // Each leaves `out` as it is where the key is missing.
  void read(const char* key, double& out) const {
    if (const Json* value = find(key)) out = number(key, *value);
  }
  void read(const char* key, bool& out) const {
    const Json* value = find(key);
    if (value == nullptr) return;
    if (!value->is_boolean()) throw wrong(key, "true or false", *value);
    out = value->get<bool>();
  }
  void read(const char* key, int& out) const {
    const Json* value = find(key);
    if (value == nullptr) return;
    // Integers beyond 2^53 are rounded on the way to double, but stay outside the range of int.
    const double n = value->is_number_integer() ? value->get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!(n >= std::numeric_limits<int>::min() && n <= std::numeric_limits<int>::max()))
      throw wrong(key, "an integer of 32 bits", *value);
    out = int(n);
  }
  void read(const char* key, std::string& out) const {
    const Json* value = find(key);
    if (value == nullptr) return;
    if (!value->is_string()) throw wrong(key, "a string", *value);
    out = value->get<std::string>();
  }
  void read(const char* key, glm::dvec3& out) const {
    const Json* value = find(key);
    if (value == nullptr) return;
    if (!value->is_array() || value->size() != 3) throw wrong(key, "an array of 3 numbers", *value);
    for (int d = 0; d < 3; ++d) out[d] = number(key, (*value)[std::size_t(d)]);
  }
  template <class Enum>
  void read(const char* key, Enum& out, const std::array<std::string_view, 2>& names) const {
    const Json* value = find(key);
    if (value == nullptr) return;
    const auto at = std::find(names.begin(), names.end(),
                              value->is_string() ? value->get_ref<const std::string&>() : std::string_view{});
    if (at == names.end()) throw wrong(key, fmt::format("{}", fmt::join(names, " or ")), *value);
    out = Enum(at - names.begin());
  }

  double number(const char* key, const Json& value) const {
    if (!value.is_number()) throw wrong(key, "a number", value);
    return value.get<double>();
  }

  hbError wrong(const char* key, std::string_view expected, const Json& value) const {
    return hbError(fmt::format("{}: {}: expected {}, found {}", place_, key, expected, found(value)));
  }

private:
  const Json& object_;
  std::string place_;
};

/// "line L, column C" of a byte of the text, both from 1; columns count bytes.
std::string lineAndColumn(const std::string& text, std::size_t at) {
  const std::string_view before = std::string_view(text).substr(0, at);
  const std::size_t lineStart = before.rfind('\n') + 1; // npos + 1 is 0
  return fmt::format("line {}, column {}", 1 + std::count(before.begin(), before.end(), '\n'),
                     before.size() - lineStart + 1);
}

Json parse(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& e) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: <what>": the end of it is of use.
    std::string_view what = e.what();
    const std::size_t syntax = what.find(": ");
    if (syntax != std::string_view::npos) what.remove_prefix(syntax + 2);
    throw hbError(fmt::format("{}: {}: {}", name, lineAndColumn(text, e.byte == 0 ? 0 : e.byte - 1), excerpt(what)));
  } catch (const Json::out_of_range& e) {
    // "[json.exception.out_of_range.406] number overflow parsing '1e999'"
    const std::string_view what = e.what();
    const std::size_t first = what.find('\'') + 1, last = what.rfind('\'');
    const std::string_view token = what.substr(first, last - first);
    throw hbError(fmt::format("{}: {}: expected a number in the range of 64-bit floats, found {}", name,
                              lineAndColumn(text, text.find(token)), excerpt(token)));
  }
}

hbCamera cameraFromJson(const Json& json, const std::string& place) {
  const ObjectReader reader(json, place, {"projection", "position", "target", "up", "fieldOfView", "height"});
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
  const ObjectReader reader(json, place, {"kind", "samples"});
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
  const auto maps = hbColormap::names();
  if (!colormap.empty() && std::find(maps.begin(), maps.end(), colormap) == maps.end())
    throw hbError(
        fmt::format("{}: colormap: expected one of {}, found '{}'", what, fmt::join(maps, ", "), excerpt(colormap)));
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
  json["component"] = scene.component;
  json["magnitude"] = scene.magnitude;
  json["width"] = scene.width;
  json["height"] = scene.height;
  return json.dump(2) + "\n";
}

hbScene hb::sceneFromJson(const std::string& text, const std::string& name) {
  const Json json = parse(text, name);
  const ObjectReader reader(json, name,
                            {"version", "mode", "camera", "sampling", "isoValue", "window", "colormap", "component",
                             "magnitude", "width", "height"});
  int version = 0;
  reader.require("version");
  reader.read("version", version);
  if (version != kVersion) throw reader.wrong("version", fmt::format("{}", kVersion), *reader.find("version"));

  hbScene scene;
  std::string mode(modeName(scene.mode));
  reader.read("mode", mode);
  if (mode != "xray" && mode != "mip" && mode != "iso")
    throw reader.wrong("mode", "xray, mip or iso", *reader.find("mode"));
  scene.mode = modeFromName(mode);
  if (const Json* camera = reader.find("camera")) scene.camera = cameraFromJson(*camera, name + ": camera");
  if (const Json* sampling = reader.find("sampling")) scene.sampling = samplingFromJson(*sampling, name + ": sampling");
  if (const Json* value = reader.find("isoValue")) scene.isoValue = reader.number("isoValue", *value);
  if (const Json* window = reader.find("window")) {
    if (!window->is_array() || window->size() != 2) throw reader.wrong("window", "an array of 2 numbers", *window);
    scene.window.emplace(reader.number("window", (*window)[0]), reader.number("window", (*window)[1]));
  }
  reader.read("colormap", scene.colormap);
  reader.read("component", scene.component);
  reader.read("magnitude", scene.magnitude);
  reader.read("width", scene.width);
  reader.read("height", scene.height);
  scene.validate(name);
  return scene;
}

hbScene hb::loadScene(const std::filesystem::path& path) {
  std::uint64_t size = 0;
  const auto bytes = mapFile(path, size);
  if (size > kMaxFileBytes)
    throw hbError(
        fmt::format("{}: expected a scene of at most {} bytes, found {}", path.string(), kMaxFileBytes, size));
  return sceneFromJson(std::string(reinterpret_cast<const char*>(bytes.get()), size), path.string());
}

void hb::saveScene(const hbScene& scene, const std::filesystem::path& path) {
  const std::string text = toJson(scene);
  hbOutputFile output(path);
  std::ofstream file(output.path(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw hbError(fmt::format("{}: cannot be written", path.string()));
  output.commit();
}
