#include "volume/hbTextFile.h"

#include <fstream>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbMappedFile.h"
#include "volume/hbOutputFile.h"

std::string hb::loadText(const std::filesystem::path& path, std::uint64_t maxBytes, std::string_view what) {
  std::uint64_t size = 0;
  const auto bytes = mapFile(path, size);
  if (size > maxBytes)
    throw hbError(fmt::format("{}: expected {} of at most {} bytes, found {}", path.string(), what, maxBytes, size));
  return std::string(reinterpret_cast<const char*>(bytes.get()), size);
}

void hb::saveText(std::string_view text, const std::filesystem::path& path) {
  hbOutputFile output(path);
  std::ofstream file(output.path(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw hbError(fmt::format("{}: cannot be written", path.string()));
  output.commit();
}

std::string hb::excerpt(std::string_view text) {
  constexpr std::size_t kLength = 200;
  std::string result(text.substr(0, kLength));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return text.size() > kLength ? result + "..." : result;
}
