#include "scene/hbTransferFunctionFile.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/hbJsonReader.h"
#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbTextFile.h"

using Json = nlohmann::json;

namespace {

using Definition = hbTransferFunction::Definition;

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 20;

// The names in JSON, in the order of the enumerators.
constexpr std::array<std::string_view, 5> kColorSpaces{"RGB", "HSV", "Lab", "Diverging", "Step"};
constexpr std::array<std::string_view, 2> kOutside{"clamp", "zero"};

/// A switch, which ParaView writes as a number.
bool flag(const hbJsonReader& reader, const char* key) {
  const Json* value = reader.find(key);
  if (value == nullptr) return false;
  if (value->is_boolean()) return value->get<bool>();
  if (*value != 0 && *value != 1) throw reader.wrong(key, "0 or 1", *value);
  return *value == 1;
}

/// The numbers of an array, four to a point, as `add(n)` with n[0] to n[3].
template <class Add>
void readPoints(const hbJsonReader& reader, const char* key, Add&& add) {
  const Json* value = reader.find(key);
  if (value == nullptr) return;
  if (!value->is_array() || value->size() % 4 != 0)
    throw reader.wrong(key, "an array of four numbers a point", value->is_array() ? Json(value->size()) : *value);
  for (std::size_t i = 0; i < value->size(); i += 4) {
    std::array<double, 4> n{};
    for (std::size_t k = 0; k < 4; ++k) n[k] = reader.number(key, (*value)[i + k]);
    add(n);
  }
}

hbTransferFunction functionFromJson(const Json& json, const std::string& place) {
  const hbJsonReader reader(json, place);
  if (reader.find("IndexedColors") != nullptr)
    throw hbError(place + ": IndexedColors: expected colours over values, found a map of categories");
  if (flag(reader, "UseLogScale"))
    throw hbError(place + ": UseLogScale: expected a linear scale, found a logarithmic one");
  Definition d;
  reader.read("Name", d.name);
  reader.require("ColorSpace");
  reader.read("ColorSpace", d.colorSpace, kColorSpaces);
  d.hsvWrap = flag(reader, "HSVWrap");
  reader.require("RGBPoints");
  readPoints(reader, "RGBPoints", [&](const auto& n) { d.colors.push_back({n[0], {n[1], n[2], n[3]}}); });
  readPoints(reader, "Points", [&](const auto& n) { d.opacities.push_back({n[0], n[1], n[2], n[3]}); });
  // ParaView's defaults of colours that are used but not given.
  if (flag(reader, "UseBelowRangeColor")) reader.read("BelowRangeColor", d.belowColor.emplace(0.0));
  if (flag(reader, "UseAboveRangeColor")) reader.read("AboveRangeColor", d.aboveColor.emplace(0.5));
  reader.read("NanColor", d.nanColor);
  reader.read("NanOpacity", d.nanOpacity);
  if (reader.find("ScalarOpacityUnitDistance") != nullptr)
    reader.read("ScalarOpacityUnitDistance", d.unitLength.emplace());
  reader.read("OpacityOutside", d.outside, kOutside);
  reader.read("Relative", d.relative);
  return hbTransferFunction(std::move(d), place);
}

nlohmann::ordered_json jsonOf(const hbTransferFunction& function) {
  const auto vector = [](const glm::dvec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  const Definition& d = function.definition();
  nlohmann::ordered_json json;
  json["ColorSpace"] = kColorSpaces[std::size_t(d.colorSpace)];
  if (d.hsvWrap) json["HSVWrap"] = 1;
  json["Name"] = d.name;
  json["NanColor"] = vector(d.nanColor);
  json["NanOpacity"] = d.nanOpacity;
  if (d.belowColor) {
    json["UseBelowRangeColor"] = 1;
    json["BelowRangeColor"] = vector(*d.belowColor);
  }
  if (d.aboveColor) {
    json["UseAboveRangeColor"] = 1;
    json["AboveRangeColor"] = vector(*d.aboveColor);
  }
  if (d.unitLength) json["ScalarOpacityUnitDistance"] = *d.unitLength;
  if (d.outside != hbTransferFunction::Outside::clamp) json["OpacityOutside"] = kOutside[std::size_t(d.outside)];
  if (d.relative) json["Relative"] = true;
  auto colors = nlohmann::ordered_json::array(), opacities = colors;
  for (const auto& p : d.colors)
    for (const double n : {p.value, p.rgb.x, p.rgb.y, p.rgb.z}) colors.push_back(n);
  for (const auto& p : d.opacities)
    for (const double n : {p.value, p.opacity, p.midpoint, p.sharpness}) opacities.push_back(n);
  json["RGBPoints"] = std::move(colors);
  json["Points"] = std::move(opacities);
  return json;
}

/// Of a colour map; "" where it has none.
std::string nameOf(const Json& json) {
  const auto name = json.is_object() ? json.find("Name") : json.end();
  return name != json.end() && name->is_string() ? name->get<std::string>() : "";
}

} // namespace

std::string hb::toJson(std::span<const hbTransferFunction> functions) {
  auto json = nlohmann::ordered_json::array();
  for (const hbTransferFunction& function : functions) json.push_back(jsonOf(function));
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::vector<hbTransferFunction> hb::transferFunctionsFromJson(const std::string& text, const std::string& source,
                                                              const std::string& only) {
  Json json = parseJson(text, source);
  if (json.is_object()) json = Json::array({std::move(json)});
  if (!json.is_array())
    throw hbError(fmt::format("{}: expected an array of colour maps, found {}", source, jsonExcerpt(json)));
  std::vector<hbTransferFunction> functions;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string name = nameOf(json[i]);
    if (!only.empty() && name != only) continue;
    functions.push_back(functionFromJson(json[i], fmt::format("{}: map {} '{}'", source, i + 1, excerpt(name))));
  }
  if (functions.empty())
    throw hbError(only.empty() ? fmt::format("{}: expected a colour map, found none", source)
                               : fmt::format("{}: expected a colour map '{}', found none among {}", source,
                                             excerpt(only), json.size()));
  return functions;
}

hbTransferFunction hb::transferFunctionFromTable(const std::string& text, const std::string& source) {
  Definition d;
  std::string_view rest = text;
  for (int line = 1; !rest.empty(); ++line) {
    std::string_view content = takeLine(rest);
    content = content.substr(0, content.find('#'));
    const auto columns = words(content);
    if (columns.empty()) continue;
    const std::string place = fmt::format("{}: line {}", source, line);
    if (columns.size() != 5)
      throw hbError(
          fmt::format("{}: expected value, red, green, blue and opacity, found {} columns", place, columns.size()));
    std::array<double, 5> n{};
    for (std::size_t k = 0; k < 5; ++k) {
      const auto number = toDouble(columns[k]);
      // The rest is checked by the function, which counts points; the line is of more use.
      if (!number || (k > 0 && !(*number >= 0.0 && *number <= 1.0)))
        throw hbError(
            fmt::format("{}: expected a number{}, found {}", place, k > 0 ? " in [0,1]" : "", excerpt(columns[k])));
      n[k] = *number;
    }
    d.colors.push_back({n[0], {n[1], n[2], n[3]}});
    d.opacities.push_back({n[0], n[4]});
  }
  return hbTransferFunction(std::move(d), source);
}

std::vector<hbTransferFunction> hb::loadTransferFunctions(const std::filesystem::path& path, const std::string& only) {
  const std::string text = loadText(path, kMaxFileBytes, "transfer functions");
  const std::string_view content = trimmed(text);
  if (content.starts_with('[') || content.starts_with('{')) return transferFunctionsFromJson(text, path.string(), only);
  return {transferFunctionFromTable(text, path.string())};
}

void hb::saveTransferFunctions(std::span<const hbTransferFunction> functions, const std::filesystem::path& path) {
  const std::string text = toJson(functions);
  if (text.size() > kMaxFileBytes)
    throw hbError(fmt::format("{}: expected transfer functions of at most {} bytes, found {}", path.string(),
                              kMaxFileBytes, text.size()));
  saveText(text, path);
}
