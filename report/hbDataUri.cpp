#include "report/hbDataUri.h"

#include <cstddef>
#include <cstdint>

#include <fmt/format.h>

#include "volume/hbTextFile.h"

std::string hb::base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0; // three bytes, what is missing 0
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::string hb::dataUri(const std::filesystem::path& path, std::string_view mediaType) {
  constexpr std::uint64_t kMostBytes = 64U << 20U;
  return fmt::format("data:{};base64,{}", mediaType, base64(loadText(path, kMostBytes, "a picture")));
}
