#pragma once

#include <nlohmann/json_fwd.hpp>

namespace app {

/// Prints what `info` found as text for a person; `bars`: with the histograms.
void printInfo(const nlohmann::ordered_json& info, bool bars);

} // namespace app
