#include "volume/fields/hbFieldParameters.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "volume/hbError.h"

std::string_view hb::fieldName(std::string_view specification) {
  return specification.substr(0, specification.find(','));
}

hbFieldParameters hb::parseFieldParameters(std::string_view specification, const hbFieldParameters& defaults) {
  hbFieldParameters parameters = defaults;
  const std::string_view name = fieldName(specification);
  std::string_view text = specification.substr(std::min(specification.size(), name.size() + 1));
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::string_view key = item.substr(0, item.find('='));
    const auto found = parameters.find(std::string(key));
    if (found == parameters.end() || key.size() == item.size()) {
      std::string names;
      for (const auto& [known, value] : parameters) names += fmt::format("{}{}=", names.empty() ? "" : ", ", known);
      throw hbError(fmt::format("field {}: expected parameters among {}, found '{}'", name, names, item));
    }
    found->second = item.substr(key.size() + 1);
  }
  return parameters;
}

double hb::fieldNumber(const hbFieldParameters& parameters, const std::string& key, double lo, double hi) {
  const std::string& text = parameters.at(key);
  double result = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result);
  if (error != std::errc() || end != text.data() + text.size() || !(lo <= result && result <= hi))
    throw hbError(fmt::format("field parameter {}: expected a number from {} to {}, found '{}'", key, lo, hi, text));
  return result;
}

std::string hb::fieldSpecification(std::string_view name, const hbFieldParameters& parameters) {
  std::string text(name);
  for (const auto& [key, value] : parameters) text += fmt::format(",{}={}", key, value);
  return text;
}
