#include "volume/hbVtkHeader.h"

#include <algorithm>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbHeaderText.h"
#include "volume/hbMappedFile.h"

namespace {

constexpr std::uint64_t kMaxHeader = 1 << 16;

} // namespace

hbVtkHeader hb::readVtkHeader(const std::filesystem::path& path) {
  std::uint64_t fileSize = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, fileSize);
  hbVtkHeader h = parseVtkHeader({reinterpret_cast<const char*>(file.get()), std::min(fileSize, kMaxHeader)}, path);
  if (h.ascii) h.textValues = countWords(path, h.dataOffset);
  return h;
}

hbVtkHeader hb::parseVtkHeader(std::string_view whole, const std::filesystem::path& path) {
  std::string_view rest = whole;
  const std::string what = path.string();
  const auto none = [&] {
    return hbError(fmt::format("{}: expected a legacy VTK file of STRUCTURED_POINTS with SCALARS or VECTORS", what));
  };
  if (!takeLine(rest).starts_with("# vtk DataFile")) throw none();
  takeLine(rest); // title

  hbVtkHeader h;
  bool structured = false;
  while (!rest.empty()) {
    const std::string_view line = takeLine(rest);
    const std::vector<std::string_view> parts = words(line);
    if (parts.empty()) continue;
    const std::string key = lowered(parts[0]);
    const auto numbers = [&] {
      glm::dvec3 v(0.0);
      for (std::size_t d = 0; d < 3; ++d) {
        const auto number = d + 1 < parts.size() ? toDouble(parts[d + 1]) : std::nullopt;
        if (!number) throw hbError(fmt::format("{}: {}: expected three numbers, found '{}'", what, parts[0], line));
        v[int(d)] = *number;
      }
      return v;
    };
    if (key == "ascii") {
      h.ascii = true;
    } else if (key == "dataset") {
      structured = parts.size() > 1 && lowered(parts[1]) == "structured_points";
      if (!structured) throw none();
    } else if (key == "dimensions") {
      for (std::size_t d = 0; d < 3; ++d) {
        const auto size = d + 1 < parts.size() ? toInteger(parts[d + 1]) : std::nullopt;
        if (!size) throw hbError(fmt::format("{}: DIMENSIONS: expected three integers, found '{}'", what, line));
        h.sizes.push_back(*size);
      }
    } else if (key == "spacing" || key == "aspect_ratio") {
      h.spacing = numbers();
    } else if (key == "origin") {
      h.origin = numbers();
    } else if (key == "cell_data") {
      throw hbError(fmt::format("{}: expected POINT_DATA first, found CELL_DATA", what));
    } else if (key == "scalars" || key == "color_scalars" || key == "vectors" || key == "tensors") {
      if (parts.size() > 1) h.name = parts[1];
      std::string_view after = rest;
      if (lowered(takeLine(after)).starts_with("lookup_table")) rest = after;
      h.dataOffset = whole.size() - rest.size();
      break;
    }
  }
  if (!structured || h.sizes.empty() || h.dataOffset == 0) throw none();
  if (h.sizes.size() != 3 || !productOf(h.sizes))
    throw hbError(fmt::format("{}: DIMENSIONS: expected at least one sample along each axis and fewer than 2^60 in "
                              "all, found {}",
                              what, sizesText(h.sizes)));
  return h;
}

std::int64_t hb::countWords(const std::filesystem::path& path, std::uint64_t offset) {
  std::uint64_t size = 0;
  const std::shared_ptr<const std::byte> file = mapFile(path, size);
  std::int64_t count = 0;
  bool inside = false;
  for (std::uint64_t i = offset; i < size; ++i) {
    const auto c = static_cast<unsigned char>(file.get()[i]);
    const bool space = c == ' ' || (c >= '\t' && c <= '\r');
    count += !space && !inside ? 1 : 0;
    inside = !space;
  }
  return count;
}
