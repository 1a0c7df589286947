#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

/// The text header of a legacy VTK file of structured points, for what ITK does not check or keep: sizes beyond 32
/// bits, samples in cells, the third coordinate of a flat grid, the name. Private to the volume reader.
struct hbVtkHeader {
  std::vector<std::int64_t> sizes; ///< Three.
  glm::dvec3 origin{0.0}, spacing{1.0};
  bool ascii = false;
  std::string name;             ///< Of the first array.
  std::uint64_t dataOffset = 0; ///< Of the first array's values.
  std::int64_t textValues = 0;  ///< Words from there to the end of the file; counted for ASCII files only.
};

namespace hb {

/// Throws hbError where the file is no such file, or its first array belongs to the cells.
hbVtkHeader readVtkHeader(const std::filesystem::path& path);

/// The same, but for the count of words, from the beginning of the file at hand, `text`; `path` is for messages.
hbVtkHeader parseVtkHeader(std::string_view text, const std::filesystem::path& path);

/// The white-space separated words of a file from `offset` on.
std::int64_t countWords(const std::filesystem::path& path, std::uint64_t offset);

} // namespace hb
