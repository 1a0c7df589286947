#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace app {

/// A number that is neither infinite nor NaN, which CLI11's ranges let through.
inline CLI::Validator isFinite() {
  return {[](const std::string& text) {
            double value = 0.0;
            return CLI::detail::lexical_cast(text, value) && std::isfinite(value)
                       ? std::string()
                       : "expected a finite number, found " + text;
          },
          ""};
}

/// Adds an option that takes one of a few names and sets `target` to what the name stands for; it keeps its value where
/// the option is not given.
template <class T>
CLI::Option* addChoice(CLI::App& command, const std::string& name, T& target,
                       const std::vector<std::pair<std::string, T>>& choices, const std::string& help) {
  std::vector<std::string> names;
  for (const auto& choice : choices) names.push_back(choice.first);
  const auto set = [&target, choices](const std::string& given) {
    for (const auto& [own, value] : choices)
      if (own == given) target = value;
  };
  return command.add_option_function<std::string>(name, set, help)->check(CLI::IsMember(names))->type_name("NAME");
}

} // namespace app
