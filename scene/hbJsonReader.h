#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "volume/hbError.h"

/// Reads one JSON object; every error is an hbError that names the place and the key. Not installed: it shows
/// nlohmann-json, which is private to the library.
class hbJsonReader {
public:
  /// Any keys. Throws hbError where `object` is no object. It must outlive the reader.
  hbJsonReader(const nlohmann::json& object, std::string place);

  /// Throws hbError for a key that is none of `keys`.
  hbJsonReader(const nlohmann::json& object, std::string place, std::initializer_list<std::string_view> keys);

  /// The value of a key, or nullptr.
  const nlohmann::json* find(const char* key) const;

  void require(const char* key) const;

  // Each leaves `out` as it is where the key is missing.
  void read(const char* key, double& out) const;
  void read(const char* key, bool& out) const;
  void read(const char* key, int& out) const;
  void read(const char* key, std::string& out) const;
  void read(const char* key, glm::dvec3& out) const;
  template <class Enum>
  void read(const char* key, Enum& out, std::span<const std::string_view> names) const {
    if (const nlohmann::json* value = find(key)) out = Enum(place(key, *value, names));
  }

  double number(const char* key, const nlohmann::json& value) const;

  /// The error to throw where the value of a key is not what was expected.
  hbError wrong(const char* key, std::string_view expected, const nlohmann::json& value) const;

private:
  /// Where among the names a string is; they are in the order of the enumerators.
  std::size_t place(const char* key, const nlohmann::json& value, std::span<const std::string_view> names) const;

  const nlohmann::json& object_;
  std::string place_;
};

namespace hb {

/// A JSON value for use in a message: "an array", "an object", or an excerpt.
std::string jsonExcerpt(const nlohmann::json& value);

/// Throws hbError beginning with `name` and giving the line and column where the text is no JSON.
nlohmann::json parseJson(const std::string& text, const std::string& name);

} // namespace hb
