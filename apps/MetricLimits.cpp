#include "apps/MetricLimits.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/Program.h"
#include "volume/hbError.h"

namespace {

using Json = nlohmann::ordered_json;

struct Limit {
  std::string metric;
  double value;
};

Limit parseLimit(const std::string& item, const std::string& option) {
  const std::size_t equals = item.find('=');
  const std::string metric = item.substr(0, equals);
  constexpr std::array kMetrics{"max", "rmse", "psnr", "ssim", "luv_mean", "luv_max"};
  if (equals == std::string::npos || std::find(kMetrics.begin(), kMetrics.end(), metric) == kMetrics.end())
    throw hbError(
        fmt::format("{}: expected METRIC=VALUE with {}, found '{}'", option, fmt::join(kMetrics, ", "), item));
  return {metric, app::parseNumbers(item.substr(equals + 1), 1, 1, option).front()};
}

} // namespace

double app::metricValue(const Json& result, const std::string& metric) {
  const Json& value = result.at(metric);
  if (!value.is_null()) return value.get<double>();
  const bool equal = result.at("max").is_number() && result.at("max").get<double>() == 0.0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return metric == "psnr" && !equal ? -kInfinity : kInfinity;
}

void app::MetricLimits::check() const {
  for (const std::string& item : above) parseLimit(item, "--fail-above");
  for (const std::string& item : below) parseLimit(item, "--fail-below");
}

void app::MetricLimits::apply(const Json& result) const {
  std::vector<std::string> lines;
  for (const std::string& item : above)
    if (const auto [metric, limit] = parseLimit(item, "--fail-above"); metricValue(result, metric) > limit)
      lines.push_back(fmt::format("{} is {}, above {}", metric, metricValue(result, metric), limit));
  for (const std::string& item : below)
    if (const auto [metric, limit] = parseLimit(item, "--fail-below"); metricValue(result, metric) < limit)
      lines.push_back(fmt::format("{} is {}, below {}", metric, metricValue(result, metric), limit));
  if (!lines.empty()) throw hbError(fmt::format("{}", fmt::join(lines, "; ")));
}
