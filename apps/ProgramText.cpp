// Numbers in options, and numbers as text.

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/Program.h"
#include "volume/hbError.h"

namespace app {

namespace {

/// The numbers between `separator`s, or nothing where one is none.
template <class T>
std::optional<std::vector<T>> split(const std::string& text, char separator) {
  std::vector<T> list;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    T value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) return std::nullopt;
    list.push_back(value);
    if (next == end) return list;
    if (*next != separator) return std::nullopt;
    at = next + 1;
  }
}

} // namespace

std::vector<std::int64_t> parseSizes(const std::string& text, std::size_t count, const std::string& option) {
  const auto valid = [](std::int64_t size) { return size >= 1 && size <= (std::int64_t{1} << 40); };
  auto sizes = split<std::int64_t>(text, 'x');
  if (sizes && sizes->size() == 1 && count == 3) sizes->resize(3, sizes->front());
  if (!sizes || sizes->size() != count || !std::all_of(sizes->begin(), sizes->end(), valid))
    throw hbError(fmt::format("{}: expected {}, found '{}'", option,
                              count == 3 ? "sizes such as 256x256x128" : "sizes such as 640x480", text));
  return *sizes;
}

std::pair<hbSize3, hbSize3> parseBox(const std::string& text, const std::string& option) {
  hbSize3 first(0), last(0);
  std::size_t at = 0;
  bool valid = true;
  for (int d = 0; d < 3; ++d) {
    const std::size_t end = d < 2 ? std::min(text.find(',', at), text.size()) : text.size();
    const auto ends = split<std::int64_t>(text.substr(at, end - at), ':');
    valid = valid && ends && ends->size() == 2 && 0 <= ends->front() && ends->front() <= ends->back();
    if (valid) first[d] = ends->front(), last[d] = ends->back();
    at = std::min(end + 1, text.size());
  }
  if (!valid)
    throw hbError(
        fmt::format("{}: expected samples from 0 on, first:last, such as 0:64,10:20,5:5, found '{}'", option, text));
  return {first, last};
}

std::vector<double> parseNumbers(const std::string& text, std::size_t least, std::size_t most,
                                 const std::string& option) {
  const auto numbers = split<double>(text, ',');
  if (!numbers || numbers->size() < least || numbers->size() > most ||
      !std::all_of(numbers->begin(), numbers->end(), [](double v) { return std::isfinite(v); }))
    throw hbError(fmt::format("{}: expected {} numbers separated by commas, found '{}'", option,
                              least == most ? std::to_string(least) : fmt::format("{} to {}", least, most), text));
  return *numbers;
}

std::string extension(const std::string& name) {
  std::string text = std::filesystem::path(name).extension().string();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

std::string bytesText(double bytes) {
  constexpr const char* kUnits[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
  int unit = 0;
  for (; bytes >= 1024.0 && unit < 6; ++unit) bytes /= 1024.0;
  return unit == 0 ? fmt::format("{:.0f} bytes", bytes)
                   : fmt::format("{:.{}f} {}", bytes,
                                 bytes < 10.0    ? 2
                                 : bytes < 100.0 ? 1
                                                 : 0,
                                 kUnits[unit]);
}

} // namespace app
