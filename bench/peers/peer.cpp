#include "bench/peers/peer.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>

#include <fmt/format.h>

namespace {

constexpr int kFailed = 1, kWrongUsage = 2, kRefused = 3;

int fail(std::string_view name, const std::string& text, int status) {
  fmt::print(stderr, "{}: {}\n", name, peer::oneLine(text));
  return status;
}

} // namespace

int peer::run(int count, char** arguments, std::string_view name, std::string_view version, std::string_view usage,
              const std::function<nlohmann::ordered_json(char** arguments)>& work) {
  try {
    if (count == 2 && std::string_view(arguments[1]) == "--version") {
      fmt::print("{} {}\n", name, version);
      return 0;
    }
    if (count != 2 + std::count(usage.begin(), usage.end(), ' '))
      return fail(name, fmt::format("expected {}", usage), kWrongUsage);
    fmt::print("{}\n", work(arguments + 1).dump());
    return 0;
  } catch (const Refused& refusal) {
    return fail(name, refusal.what(), kRefused);
  } catch (const std::exception& error) {
    return fail(name, error.what(), kFailed);
  }
}

std::string peer::oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.erase(text.find_last_not_of(' ') + 1); // npos + 1 is 0
}

std::uint64_t peer::wholeNumber(std::string_view text, const std::string& what, std::uint64_t least,
                                std::uint64_t most) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < least || number > most)
    throw hbError(fmt::format("{}: expected a whole number from {} to {}, found '{}'", what, least, most, text));
  return number;
}

double peer::seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
