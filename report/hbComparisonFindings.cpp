#include "report/hbComparisonFindings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/hbParetoFront.h"

namespace {

using Json = hb::ReportJson;

bool isDone(const Json& one) { return one["status"] == "done"; }

/// Whether its picture errors are figures of values like everybody else's.
bool isMeasured(const Json& one) { return isDone(one) && !one.value("image_only", false); }

double number(const Json& json, const char* pointer) { return json.at(Json::json_pointer(pointer)).get<double>(); }

/// Infinite where it is null: sums of squares of very large values overflow.
double orInfinite(const Json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

double frame(const Json& one) { return number(one, "/seconds_frame/median"); }

void markFront(Json& report, const char* mark, const std::function<double(const Json&)>& cost) {
  std::map<std::string, std::vector<std::size_t>> modes;
  Json& cases = report["cases"];
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i][mark] = false;
    if (isMeasured(cases[i]) && cases[i]["picture"]["rmse"].is_number()) modes[cases[i]["mode"]].push_back(i);
  }
  for (const auto& [mode, members] : modes) {
    std::vector<hb::CostAndError> choices;
    for (const std::size_t i : members) choices.push_back({cost(cases[i]), number(cases[i], "/picture/rmse")});
    const std::vector<bool> front = hb::paretoFront(choices);
    for (std::size_t i = 0; i < members.size(); ++i) cases[members[i]][mark] = bool(front[i]);
  }
}

/// The distance of nodes along the finest axis, in lengths of the cube; 0 for choices that have none.
double meshWidth(const Json& choice) {
  if (hbComparison::isSparseGrid(choice["kind"].get<std::string>())) return std::exp2(-choice["level"].get<double>());
  if (choice["kind"] != "coarse" || !choice.value("size", Json()).is_array()) return 0.0;
  const double nodes = *std::max_element(choice["size"].begin(), choice["size"].end());
  return nodes > 1.0 ? 1.0 / (nodes - 1.0) : 0.0;
}

Json order(const Json& before, const Json& choice, const char* errors) {
  const auto rmse = [&](const Json& one) {
    const Json& set = one[errors];
    return set.is_object() && set["rmse"].is_number() ? set["rmse"].get<double>() : 0.0;
  };
  const double ratio = std::log(meshWidth(before) / meshWidth(choice));
  if (!(rmse(before) > 0.0) || !(rmse(choice) > 0.0) || !(ratio > 0.0)) return nullptr;
  return hb::finiteOrNull(std::log(rmse(before) / rmse(choice)) / ratio);
}

std::string bytesText(double bytes) {
  if (bytes < 1024.0) return fmt::format("{:.0f} bytes", bytes);
  if (bytes < 1048576.0) return fmt::format("{:.4g} kB", bytes / 1024.0);
  return fmt::format("{:.4g} MB", bytes / 1048576.0);
}

/// Of the items for which `isIn` holds, the one with the least `rank`; null where there is none.
template <class Rank>
const Json* best(const Json& items, const std::function<bool(const Json&)>& isIn, const Rank& rank) {
  const Json* found = nullptr;
  for (const Json& item : items)
    if (isIn(item) && (!found || rank(item) < rank(*found))) found = &item;
  return found;
}

class Recommendations {
public:
  Recommendations(const Json& report, const hbComparison::Limits& limits) : report_(report), limits_(limits) {
    for (const Json& choice : report["choices"]) choices_[choice["key"]] = &choice;
  }

  Json all() {
    forError();
    for (const Json& mode : report_["settings"]["modes"]) forFrame(mode);
    forBytes();
    if (const Json& settings = report_["settings"]; settings.contains("fits"))
      for (const Json& kind : settings["fits"]) forFit(kind);
    return list_;
  }

private:
  void add(const std::string& question, const Json& limit, const Json& mode, const Json* choice, const Json* one,
           const std::string& answer) {
    list_.push_back({{"question", question},
                     {"limit", limit},
                     {"mode", mode},
                     {"choice", choice ? (*choice)["key"] : Json()},
                     {"case", one ? (*one)["key"] : Json()},
                     {"answer", answer}});
  }

  /// Of a choice the frames that take least, in words: "xray 3.1 ms by lattice, ...".
  std::string fastestFrames(const Json& choice) const {
    std::string text;
    for (const Json& mode : report_["settings"]["modes"]) {
      const Json* fastest = best(
          report_["cases"],
          [&](const Json& one) { return isMeasured(one) && one["choice"] == choice["key"] && one["mode"] == mode; },
          frame);
      if (fastest)
        text += fmt::format("{}{} {:.3g} ms by {}", text.empty() ? "" : ", ", mode.get<std::string>(),
                            frame(*fastest) * 1e3, (*fastest)["engine"].get<std::string>());
    }
    return text.empty() ? "no frame was drawn" : "a frame: " + text;
  }

  std::string inWords(const Json& choice) const {
    const Json& values = choice["values"];
    return fmt::format("{}: {}, {:.4g} bits a sample, max error {:.4g}, RMSE {:.4g}; {}",
                       choice["label"].get<std::string>(), bytesText(choice["bytes"].get<double>()),
                       choice["bits_per_sample"].get<double>(), orInfinite(values["max"]), orInfinite(values["rmse"]),
                       fastestFrames(choice));
  }

  void forError() {
    const Json& range = report_["input"]["range"];
    const double width =
        range[0].is_number() && range[1].is_number() ? range[1].get<double>() - range[0].get<double>() : 0.0;
    const double limit = limits_.maxError.value_or(0.01 * width);
    const Json* choice = best(
        report_["choices"],
        [&](const Json& c) { return isDone(c) && c["values"]["max"].is_number() && c["values"]["max"] <= limit; },
        [](const Json& c) { return std::pair(number(c, "/bytes"), orInfinite(c["values"]["rmse"])); });
    add(fmt::format("max error <= {:.4g}", limit), limit, nullptr, choice, nullptr,
        choice ? inWords(*choice) : "none of these");
  }

  void forFrame(const Json& mode) {
    const double limit = limits_.frameSeconds.value_or(0.1);
    const auto find = [&](bool isCompressed) {
      return best(
          report_["cases"],
          [&](const Json& one) {
            return isMeasured(one) && one["mode"] == mode && one["picture"]["rmse"].is_number() &&
                   frame(one) <= limit && !(isCompressed && one["choice"] == "original");
          },
          [](const Json& one) {
            return std::tuple(number(one, "/picture/rmse"), number(one, "/compressed_bytes"), frame(one));
          });
    };
    const Json* one = find(false);
    std::string answer = one ? inWordsOf(*one) : "none of these";
    if (one && (*one)["choice"] == "original")
      if (const Json* compressed = find(true)) answer += "; compressed, " + inWordsOf(*compressed);
    add(fmt::format("a frame of {} <= {:.4g} ms", mode.get<std::string>(), limit * 1e3), limit, mode,
        one ? choices_.at((*one)["choice"]) : nullptr, one, answer);
  }

  std::string inWordsOf(const Json& one) const {
    const Json& psnr = one["picture"]["psnr"];
    const bool isExact = one["picture"]["max"] == 0.0;
    return fmt::format("{} by {}: {:.3g} ms, {}, picture {}", (*choices_.at(one["choice"]))["label"].get<std::string>(),
                       one["engine"].get<std::string>(), frame(one) * 1e3,
                       bytesText(one["compressed_bytes"].get<double>()),
                       isExact            ? "exact"
                       : psnr.is_number() ? fmt::format("{:.4g} dB", psnr.get<double>())
                                          : fmt::format("RMSE {:.4g}", orInfinite(one["picture"]["rmse"])));
  }

  void forBytes() {
    const double limit = limits_.bytes.value_or(0.01 * number(report_, "/input/bytes_uncompressed"));
    const Json* choice = best(
        report_["choices"],
        [&](const Json& c) { return isDone(c) && c["values"]["rmse"].is_number() && number(c, "/bytes") <= limit; },
        [](const Json& c) { return std::pair(number(c, "/values/rmse"), number(c, "/bytes")); });
    add("at most " + bytesText(limit), limit, nullptr, choice, nullptr, choice ? inWords(*choice) : "none of these");
  }

  /// Of the interpolating grids for which `isIn` holds, the one with the least RMSE; null where there is none.
  const Json* interpolating(const std::function<bool(const Json&)>& isIn) const {
    return best(
        report_["choices"], [&](const Json& c) { return c["kind"] == "sparse" && isDone(c) && isIn(c); },
        [](const Json& c) { return orInfinite(c["values"]["rmse"]); });
  }

  const Json* interpolatingAtLevelOf(const Json& fit) const {
    return interpolating([&](const Json& c) { return c["level"] == fit["level"]; });
  }

  void forFit(const Json& kind) {
    const auto isGain = [&](const Json& c) {
      return c["kind"] == kind && isDone(c) && c["fit"]["improved"] == true && interpolatingAtLevelOf(c) != nullptr &&
             orInfinite(c["values"]["rmse"]) < orInfinite((*interpolatingAtLevelOf(c))["values"]["rmse"]);
    };
    const auto isMade = [&](const Json& c) { return c["kind"] == kind && isDone(c); };
    const bool none = std::none_of(report_["choices"].begin(), report_["choices"].end(), isMade);
    const Json* fit = best(report_["choices"], isGain, [&](const Json& c) {
      return orInfinite(c["values"]["rmse"]) / orInfinite((*interpolatingAtLevelOf(c))["values"]["rmse"]);
    });
    add("a fit by " + kind.get<std::string>(), nullptr, nullptr, fit, nullptr,
        fit    ? inWords(*fit, *interpolatingAtLevelOf(*fit))
        : none ? "none of these: all failed"
               : "none of these: no better than interpolation");
  }

  std::string inWords(const Json& fit, const Json& same) const {
    const Json* within = interpolating([&](const Json& c) { return c["bytes"] <= fit["bytes"]; });
    return fmt::format("{}: RMSE {:.4g} instead of {:.4g} by interpolation, {} instead of {}, made in {:.3g} s instead "
                       "of {:.3g} s{}",
                       fit["label"].get<std::string>(), orInfinite(fit["values"]["rmse"]),
                       orInfinite(same["values"]["rmse"]), bytesText(number(fit, "/bytes")),
                       bytesText(number(same, "/bytes")), number(fit, "/seconds_build"), number(same, "/seconds_build"),
                       within ? fmt::format("; in no more bytes interpolation has RMSE {:.4g}, at level {}",
                                            orInfinite((*within)["values"]["rmse"]), (*within)["level"].get<int>())
                              : std::string());
  }

  const Json& report_;
  const hbComparison::Limits& limits_;
  std::map<std::string, const Json*> choices_;
  Json list_ = Json::array();
};

} // namespace

void hb::markParetoFronts(ReportJson& report) {
  markFront(report, "pareto_time", frame);
  markFront(report, "pareto_bytes", [](const Json& one) { return number(one, "/compressed_bytes"); });
}

void hb::addConvergenceOrders(ReportJson& report) {
  std::map<std::string, const Json*> before;
  for (Json& choice : report["choices"]) {
    choice["order"] = choice["true_order"] = nullptr;
    if (!isDone(choice)) continue;
    const Json*& last = before[choice["kind"]];
    if (last && meshWidth(choice) > 0.0) {
      choice["order"] = order(*last, choice, "values");
      choice["true_order"] = order(*last, choice, "true_values");
    }
    last = &choice;
  }
}

void hb::addRecommendations(ReportJson& report, const hbComparison::Limits& limits) {
  report["recommendations"] = Recommendations(report, limits).all();
}
