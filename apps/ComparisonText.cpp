#include "apps/ComparisonText.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace {

/// Infinite where it is null: sums of squares of very large values overflow.
double number(const nlohmann::ordered_json& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::infinity();
}

void printHardCases(const nlohmann::ordered_json& hard) {
  if (hard.is_null()) return;
  int done = 0, within = 0, beyond = 0, refused = 0, failed = 0;
  for (const auto& one : hard["cases"])
    for (const auto& result : one["results"]) {
      done += result["status"] == "done" ? 1 : 0;
      refused += result["status"] == "refused" ? 1 : 0;
      failed += result["status"] == "failed" ? 1 : 0;
      within += result["within_bound"] == true ? 1 : 0;
      beyond += result["exceeds_bound"] == true ? 1 : 0;
    }
  const int silent = done - within - beyond;
  fmt::print("\nhard cases: {} of {} results are within their bounds, {} beyond; {} bounds make no statement; "
             "{} refused, {} failed\n",
             within, done, beyond, silent, refused, failed);
}

} // namespace

void app::printComparison(const nlohmann::ordered_json& report, const std::string& out) {
  std::size_t width = 28;
  for (const auto& choice : report["choices"]) width = std::max(width, choice["label"].get<std::string>().size());
  fmt::print("{:<{}} {:>10} {:>12} {:>10} {:>10} {:>10}\n", "choice", width, "kB", "bits/sample", "max error", "RMSE",
             "PSNR");
  for (const auto& choice : report["choices"]) {
    if (choice["status"] != "done") {
      fmt::print("{:<{}} failed: {}\n", choice["label"].get<std::string>(), width, choice["error"].get<std::string>());
      continue;
    }
    const auto& values = choice["values"];
    fmt::print("{:<{}} {:>10.1f} {:>12.4f} {:>10.4g} {:>10.4g} {:>10}\n", choice["label"].get<std::string>(), width,
               choice["bytes"].get<double>() / 1024.0, choice["bits_per_sample"].get<double>(), number(values["max"]),
               number(values["rmse"]),
               values["psnr"].is_number() ? fmt::format("{:.2f} dB", values["psnr"].get<double>())
               : values["max"] == 0.0     ? "equal"
                                          : "-");
  }
  fmt::print("\n");
  for (const auto& one : report["recommendations"])
    fmt::print("for {}: {}\n", one["question"].get<std::string>(), one["answer"].get<std::string>());
  const auto failed = std::count_if(report["cases"].begin(), report["cases"].end(),
                                    [](const auto& one) { return one["status"] != "done"; });
  if (failed > 0) fmt::print("\n{} of {} cases failed; the page says why\n", failed, report["cases"].size());
  printHardCases(report["hard_cases"]);
  fmt::print("\n{}\n", (std::filesystem::path(out) / "index.html").string());
}
