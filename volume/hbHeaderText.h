#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Small tools for text headers and tables. Not installed.
namespace hb {

std::string_view trimmed(std::string_view text);
std::string lowered(std::string_view text);

/// Cuts off and returns the first line, without its end (\n or \r\n).
std::string_view takeLine(std::string_view& text);

/// Words separated by white space.
std::vector<std::string_view> words(std::string_view text);

/// The number that is the whole text, in the C locale; nothing where it is not one (or does not fit).
std::optional<std::int64_t> toInteger(std::string_view text);
std::optional<double> toDouble(std::string_view text);

/// The product; nothing where a factor is below 1 or it reaches 2^60.
std::optional<std::int64_t> productOf(const std::vector<std::int64_t>& sizes);

/// "3 x 4 x 5".
std::string sizesText(const std::vector<std::int64_t>& sizes);

} // namespace hb
