#include "scene/hbJsonReader.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "volume/hbTextFile.h"

using Json = nlohmann::json;

namespace {

/// "line L, column C" of a byte of the text, both from 1; columns count bytes.
std::string lineAndColumn(const std::string& text, std::size_t at) {
  const std::string_view before = std::string_view(text).substr(0, at);
  const std::size_t lineStart = before.rfind('\n') + 1; // npos + 1 is 0
  return fmt::format("line {}, column {}", 1 + std::count(before.begin(), before.end(), '\n'),
                     before.size() - lineStart + 1);
}

} // namespace

std::string hb::jsonExcerpt(const Json& value) {
  return value.is_structured() ? value.is_array() ? "an array" : "an object"
                               : excerpt(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

Json hb::parseJson(const std::string& text, const std::string& name) {
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

hbJsonReader::hbJsonReader(const Json& object, std::string place) : object_(object), place_(std::move(place)) {
  if (!object.is_object())
    throw hbError(fmt::format("{}: expected an object, found {}", place_, hb::jsonExcerpt(object)));
}

hbJsonReader::hbJsonReader(const Json& object, std::string place, std::initializer_list<std::string_view> keys)
    : hbJsonReader(object, std::move(place)) {
  for (const auto& item : object.items())
    if (std::find(keys.begin(), keys.end(), item.key()) == keys.end())
      throw hbError(
          fmt::format("{}: {}: unknown key; known are {}", place_, hb::excerpt(item.key()), fmt::join(keys, ", ")));
}

const Json* hbJsonReader::find(const char* key) const {
  const auto at = object_.find(key);
  return at == object_.end() ? nullptr : &*at;
}

void hbJsonReader::require(const char* key) const {
  if (find(key) == nullptr) throw hbError(fmt::format("{}: {}: expected, but missing", place_, key));
}

void hbJsonReader::read(const char* key, double& out) const {
  if (const Json* value = find(key)) out = number(key, *value);
}

void hbJsonReader::read(const char* key, bool& out) const {
  const Json* value = find(key);
  if (value == nullptr) return;
  if (!value->is_boolean()) throw wrong(key, "true or false", *value);
  out = value->get<bool>();
}

void hbJsonReader::read(const char* key, int& out) const {
  const Json* value = find(key);
  if (value == nullptr) return;
  // Integers beyond 2^53 are rounded on the way to double, but stay outside the range of int.
  const double n = value->is_number_integer() ? value->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(n >= std::numeric_limits<int>::min() && n <= std::numeric_limits<int>::max()))
    throw wrong(key, "an integer of 32 bits", *value);
  out = int(n);
}

void hbJsonReader::read(const char* key, std::string& out) const {
  const Json* value = find(key);
  if (value == nullptr) return;
  if (!value->is_string()) throw wrong(key, "a string", *value);
  out = value->get<std::string>();
}

void hbJsonReader::read(const char* key, glm::dvec3& out) const {
  const Json* value = find(key);
  if (value == nullptr) return;
  if (!value->is_array() || value->size() != 3) throw wrong(key, "an array of 3 numbers", *value);
  for (int d = 0; d < 3; ++d) out[d] = number(key, (*value)[std::size_t(d)]);
}

double hbJsonReader::number(const char* key, const Json& value) const {
  if (!value.is_number()) throw wrong(key, "a number", value);
  return value.get<double>();
}

hbError hbJsonReader::wrong(const char* key, std::string_view expected, const Json& value) const {
  return hbError(fmt::format("{}: {}: expected {}, found {}", place_, key, expected, hb::jsonExcerpt(value)));
}

std::size_t hbJsonReader::place(const char* key, const Json& value, std::span<const std::string_view> names) const {
  const auto at = std::find(names.begin(), names.end(),
                            value.is_string() ? value.get_ref<const std::string&>() : std::string_view{});
  if (at == names.end()) throw wrong(key, fmt::format("{}", fmt::join(names, " or ")), value);
  return std::size_t(at - names.begin());
}
