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

const std::vector<hbComparison::Fit>& hbComparison::allFits() {
  static const std::vector<Fit> all{{"opticom", hbFit::Method::opticom},
                                    {"least-squares", hbFit::Method::leastSquares}};
  return all;
}

std::string hbComparison::Fit::inWords() const {
  std::string words = name;
  std::replace(words.begin(), words.end(), '-', ' ');
  return words;
}

bool hbComparison::isSparseGrid(std::string_view kind) {
  return kind == "sparse" ||
         std::any_of(allFits().begin(), allFits().end(), [&](const Fit& fit) { return fit.name == kind; });
}

void hbComparison::validate() const {
  if (firstLevel < 1 || lastLevel > hbIndexSet::kMaxLevel || firstLevel > lastLevel)
    throw hbError(fmt::format("levels: expected A..B with 1 <= A <= B <= {}, found {}..{}", hbIndexSet::kMaxLevel,
                              firstLevel, lastLevel));
  if (engines.empty()) throw hbError("engines: expected at least one");
  if (modes.empty()) throw hbError("modes: expected at least one");
  if (std::find(modes.begin(), modes.end(), hbMode::slice) != modes.end())
    throw hbError("modes: expected xray, mip, iso or dvr, found slice");
  for (auto fit = fits.begin(); fit != fits.end(); ++fit)
    if (std::find(fits.begin(), fit, *fit) != fit)
      throw hbError(fmt::format("fits: expected each once, found {} twice", fit->name));
  if (loss != hbFitLoss::Kind::none && fits.empty())
    throw hbError("loss: expected a fit beside it, found interpolation only");
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
  for (const Fit& fit : fits) json["fits"].push_back(fit.name);
  if (!fits.empty()) json["loss"] = hbFitLoss{loss}.name();
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
