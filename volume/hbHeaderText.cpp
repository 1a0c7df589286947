#include "volume/hbHeaderText.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace {

constexpr std::string_view kSpaces = " \t\r\n\v\f";

template <class T>
std::optional<T> toNumber(std::string_view text) {
  text = hb::trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

} // namespace

std::string_view hb::trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpaces) - first + 1);
}

std::string hb::lowered(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return result;
}

std::string_view hb::takeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> hb::words(std::string_view text) {
  std::vector<std::string_view> result;
  for (std::size_t at = text.find_first_not_of(kSpaces); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.size(), text.find_first_of(kSpaces, at));
    result.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kSpaces, end);
  }
  return result;
}

std::optional<std::int64_t> hb::toInteger(std::string_view text) { return toNumber<std::int64_t>(text); }
std::optional<double> hb::toDouble(std::string_view text) { return toNumber<double>(text); }

std::optional<std::int64_t> hb::productOf(const std::vector<std::int64_t>& sizes) {
  std::int64_t product = 1;
  for (const std::int64_t size : sizes) {
    if (size < 1 || size >= (std::int64_t{1} << 60) / product) return {};
    product *= size;
  }
  return product;
}

std::string hb::sizesText(const std::vector<std::int64_t>& sizes) { return fmt::format("{}", fmt::join(sizes, " x ")); }
