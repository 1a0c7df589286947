#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace app {

/// What `diff` fails at: METRIC=VALUE pairs.
struct MetricLimits {
  std::vector<std::string> above, below;

  /// Throws hbError for what is no such pair.
  void check() const;
  /// Throws hbError naming the metrics of a result that are beyond a limit.
  void apply(const nlohmann::ordered_json& result) const;
};

/// A metric as a number: an error that JSON has no number for is infinite; so is the PSNR where nothing differs.
double metricValue(const nlohmann::ordered_json& result, const std::string& metric);

} // namespace app
