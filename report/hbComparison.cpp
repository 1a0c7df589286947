#include "report/hbComparison.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sparsegrid/hbIndexSet.h"
#include "volume/hbError.h"

const std::vector<hbComparison::Engine>& hbComparison::allEngines() {
  using Form = hbOglRaycaster::Form;
  static const std::vector<Engine> all{{"seminodal", hbEngine::seminodal, Form::seminodal},
                                       {"direct", hbEngine::direct, Form::seminodal},
                                       {"combination", hbEngine::combination, Form::seminodal},
                                       {"lattice", hbEngine::lattice, Form::seminodal},
                                       {"full", hbEngine::full, Form::seminodal},
                                       {"opengl", hbEngine::opengl, Form::seminodal},
                                       {"opengl-fused", hbEngine::opengl, Form::fused},
                                       {"opengl-blend", hbEngine::opengl, Form::blend}};
  return all;
}

hbComparison::Engine hbComparison::engineFromName(std::string_view name) {
  std::string names;
  for (const Engine& engine : allEngines()) {
    if (engine.name == name) return engine;
    names += (names.empty() ? "" : ", ") + engine.name;
  }
  throw hbError(fmt::format("engine: expected {}, found {}", names, name));
}

void hbComparison::validate() const {
  if (firstLevel < 1 || lastLevel > hbIndexSet::kMaxLevel || firstLevel > lastLevel)
    throw hbError(fmt::format("levels: expected A..B with 1 <= A <= B <= {}, found {}..{}", hbIndexSet::kMaxLevel,
                              firstLevel, lastLevel));
  if (engines.empty()) throw hbError("engines: expected at least one");
  if (modes.empty()) throw hbError("modes: expected at least one");
  if (std::find(modes.begin(), modes.end(), hbMode::slice) != modes.end())
    throw hbError("modes: expected xray, mip, iso or dvr, found slice");
  if (scene.magnitude || scene.labels || scene.slice)
    throw hbError("scene: expected values of one component, found magnitudes, labels or a slice");
  if (scene.sampling.samples < 1) throw hbError("samples: expected at least 1");
  if (repeats < 1) throw hbError(fmt::format("repeats: expected at least 1, found {}", repeats));
}

nlohmann::ordered_json hbComparison::settings() const {
  nlohmann::ordered_json json;
  for (int level = firstLevel; level <= lastLevel; ++level) json["levels"].push_back(level);
  for (const Engine& engine : engines) json["engines"].push_back(engine.name);
  for (const hbMode mode : modes) json["modes"].push_back(hb::modeName(mode));
  json["width"] = scene.width;
  json["height"] = scene.height;
  json["samples"] = scene.sampling.samples;
  json["sampling"] = scene.sampling.kind == hbSampling::Kind::planewise ? "planewise" : "equidistant";
  json["repeats"] = repeats;
  json["threads"] = threads;
  json["nan_value"] = nonFinite ? nlohmann::ordered_json(*nonFinite) : nlohmann::ordered_json();
  json["scene"] = nlohmann::ordered_json::parse(hb::toJson(scene));
  return json;
}
