#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace app {

/// Prints what a comparison's report comes to: what each choice costs and loses, what is recommended, what failed, and
/// where the page lies, in the folder `out`.
void printComparison(const nlohmann::ordered_json& report, const std::string& out);

} // namespace app
