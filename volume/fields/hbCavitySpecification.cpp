#include "volume/fields/hbCavitySpecification.h"

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
  if (parameters.at("end-time") != "steady") result.endTime = number("end-time", 0.0, 1e4);
  result.tolerance = number("tolerance", 1e-9, 1.0);
  result.maxSteps = std::int64_t(number("max-steps", 1.0, 1e7));
  result.text = hb::fieldSpecification(kName, parameters);
  return result;
}
