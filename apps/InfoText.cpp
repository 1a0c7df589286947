#include "apps/InfoText.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::ordered_json;

std::string shortText(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (!value.is_array() && !value.is_object()) return value.dump();
  std::string text;
  for (const auto& [key, item] : value.items())
    text += fmt::format("{}{}{}",
                        text.empty()        ? ""
                        : value.is_object() ? ", "
                                            : " ",
                        value.is_object() ? key + " " : "", shortText(item));
  return text;
}

void addBars(std::string& text, const Json& statistics) {
  const auto bins = statistics["bins"].get<std::vector<std::int64_t>>();
  if (bins.empty() || statistics["min"].is_null()) return;
  const double lo = statistics["min"], hi = statistics["max"];
  const auto most = double(std::max<std::int64_t>(1, *std::max_element(bins.begin(), bins.end())));
  constexpr double kWidth = 60.0;
  for (std::size_t i = 0; i < bins.size(); ++i) // square roots, so that small bins show beside a dominant background
    text += fmt::format("  {:>12.5g} {:>12} {}\n", lo + (hi - lo) * double(i) / double(bins.size()), bins[i],
                        std::string(std::size_t(std::ceil(kWidth * std::sqrt(double(bins[i]) / most))), '#'));
}

} // namespace

std::string app::infoText(const Json& info, bool bars) {
  std::string text;
  for (const auto& [key, value] : info.items()) {
    if (value.is_null() || key == "statistics" || (value.is_string() && value.get<std::string>().empty())) continue;
    if (key == "dims")
      text += fmt::format("{:<26}{} x {} x {}\n", key, value[0].get<std::int64_t>(), value[1].get<std::int64_t>(),
                          value[2].get<std::int64_t>());
    else if (value.is_object())
      for (const auto& [inner, item] : value.items()) {
        if (const std::string line = shortText(item); !line.empty()) text += fmt::format("{:<26}{}\n", inner, line);
      }
    else
      text += fmt::format("{:<26}{}\n", key, shortText(value));
  }
  if (!info.contains("statistics")) return text;
  int component = 0;
  for (const Json& s : info["statistics"]) {
    text += fmt::format("component {}: {} values from {} to {}, mean {}, deviation {}, NaN {}, infinite {}\n",
                        component++, s["count"].dump(), shortText(s["min"]), shortText(s["max"]), shortText(s["mean"]),
                        shortText(s["deviation"]), s["nans"].dump(), s["infinities"].dump());
    if (bars) addBars(text, s);
  }
  return text;
}
