#include "volume/hbMetaImageHeader.h"

#include <algorithm>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbMappedFile.h"

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kMaxHeader = 1 << 20;
constexpr std::size_t kMaxLine = 1000; // MetaIO reads lines into fixed arrays
constexpr std::int64_t kMaxDimensions = 10;
constexpr std::int64_t kMaxComponents = 65536;

} // namespace

hbMetaImageHeader hb::readMetaImageHeader(const fs::path& path) {
  std::uint64_t fileSize = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, fileSize);
  return parseMetaImageHeader({reinterpret_cast<const char*>(file.get()), std::min(fileSize, kMaxHeader)}, path);
}

hbMetaImageHeader hb::parseMetaImageHeader(std::string_view whole, const fs::path& path) {
  std::string_view rest = whole;
  const std::string what = path.string();
  hbMetaImageHeader h;
  bool complete = false;
  while (!rest.empty() && !complete) {
    const std::string_view line = takeLine(rest);
    if (trimmed(line).empty()) continue;
    const std::size_t equals = line.find('=');
    if (line.size() > kMaxLine || equals == std::string_view::npos)
      throw hbError(
          fmt::format("{}: expected MetaImage header lines 'Key = value' of at most {} characters, found '{}'", what,
                      kMaxLine, line.substr(0, 40)));
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    const bool yes = value.starts_with('T') || value.starts_with('t') || value.starts_with('1');
    const auto integer = [&](std::int64_t lo, std::int64_t hi) {
      const auto number = toInteger(value);
      if (!number || *number < lo || *number > hi)
        throw hbError(fmt::format("{}: {}: expected an integer from {} to {}, found '{}'", what, key, lo, hi, value));
      return *number;
    };
    if (key == "NDims") {
      integer(1, kMaxDimensions);
    } else if (key == "DimSize") {
      for (const std::string_view word : words(value)) {
        const auto size = toInteger(word);
        if (!size) throw hbError(fmt::format("{}: DimSize: expected integers below 2^63, found '{}'", what, word));
        h.sizes.push_back(*size);
      }
    } else if (key == "ElementNumberOfChannels") {
      h.components = integer(1, kMaxComponents);
    } else if (key == "BinaryData") {
      h.ascii = !yes;
    } else if (key == "CompressedData") {
      h.compressed = yes;
    } else if (key == "BinaryDataByteOrderMSB" || key == "ElementByteOrderMSB") {
      h.bigEndian = yes;
    } else if (key == "AnatomicalOrientation") {
      h.oriented = !value.empty() && value.find('?') == std::string_view::npos;
    } else if (key == "HeaderSize") {
      h.headerSize = integer(-1, INT64_MAX);
    } else if (key == "ElementDataFile") {
      complete = true;
      if (value.starts_with("LIST")) {
        while (!rest.empty())
          if (const auto name = trimmed(takeLine(rest)); !name.empty())
            h.files.push_back(path.parent_path() / fs::path(name));
      } else if (value.find('%') != std::string_view::npos) {
        throw hbError(fmt::format("{}: ElementDataFile: expected LOCAL, one file or LIST and the files' names, found "
                                  "the pattern '{}'",
                                  what, value));
      } else if (lowered(value) != "local") {
        h.files.push_back(path.parent_path() / fs::path(value));
      }
    }
  }
  if (!complete || h.sizes.empty())
    throw hbError(fmt::format("{}: expected a MetaImage header with DimSize and ElementDataFile", what));
  if (!productOf(h.sizes))
    throw hbError(fmt::format("{}: DimSize: expected at least one sample along each axis and fewer than 2^60 in all, "
                              "found {}",
                              what, sizesText(h.sizes)));
  h.dataOffset = whole.size() - rest.size();
  return h;
}
