#include "volume/fields/hbCavitySpecification.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "volume/hbError.h"

namespace {

std::optional<double> parseEndTime(const std::string& text) {
  constexpr double kLatest = 1e4;
  if (text == "steady") return {};
  double time = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error != std::errc() || end != text.data() + text.size() || !(time > 0.0 && time <= kLatest))
    throw hbError(fmt::format("field parameter end-time: expected a positive time up to {}, or steady, found '{}'",
                              kLatest, text));
  return time;
}

} // namespace

const hbFieldParameters& hbCavitySpecification::defaults() {
  // Without buoyancy the flow is the one that published velocities of this cavity belong to.
  static const hbFieldParameters parameters{{"quantity", "pressure"}, {"reynolds", "1000"},   {"prandtl", "0.71"},
                                            {"richardson", "0"},      {"end-time", "steady"}, {"tolerance", "0.0005"},
                                            {"max-steps", "4000"}};
  return parameters;
}

hbCavitySpecification hbCavitySpecification::parse(std::string_view specification) {
  const hbFieldParameters parameters = hb::parseFieldParameters(specification, defaults());
  const auto number = [&](const char* key, double lo, double hi) { return hb::fieldNumber(parameters, key, lo, hi); };
  hbCavitySpecification result;
  result.flow = {number("reynolds", 0.01, 1e4), number("prandtl", 0.01, 100.0), number("richardson", -10.0, 10.0)};
  result.quantity = hb::cavityQuantityFromName(parameters.at("quantity"));
  result.endTime = parseEndTime(parameters.at("end-time"));
  result.tolerance = number("tolerance", 1e-9, 1.0);
  const double maxSteps = number("max-steps", 1.0, 1e7);
  if (maxSteps != std::floor(maxSteps))
    throw hbError(
        fmt::format("field parameter max-steps: expected a whole number, found '{}'", parameters.at("max-steps")));
  result.maxSteps = std::int64_t(maxSteps);
  result.text = hb::fieldSpecification(kName, parameters);
  return result;
}
