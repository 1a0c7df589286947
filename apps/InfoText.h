#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace app {

/// What `info` found as text for a person; `bars`: with the histograms.
std::string infoText(const nlohmann::ordered_json& info, bool bars);

} // namespace app
