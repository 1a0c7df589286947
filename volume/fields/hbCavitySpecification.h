#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "volume/fields/hbCavityFlow.h"
#include "volume/fields/hbFieldParameters.h"

/// What simulated cavity is asked for: "cavity[,parameter=value...]" as it stands on a command line.
struct hbCavitySpecification {
  static constexpr std::string_view kName = "cavity";
  static const hbFieldParameters& defaults();

  hbCavityFlow::Parameters flow;
  hbCavityFlow::Quantity quantity = hbCavityFlow::Quantity::pressure;
  std::optional<double> endTime; ///< Positive. Nothing: the steady flow.
  double tolerance = 0.0;
  std::int64_t maxSteps = 0; ///< Without an end time.
  std::string text;          ///< With every parameter: parse(text) gives the same.

  /// Throws hbError for an unknown parameter, or a value out of range.
  static hbCavitySpecification parse(std::string_view specification);
};
