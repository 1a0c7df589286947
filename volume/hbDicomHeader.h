#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <glm/vec3.hpp>

/// What a DICOM file says about its pixels and its place in a series. Private to the volume reader.
///
/// Reading it walks the whole structure of the file (DICOM PS3.5, chapter 7), which GDCM must not see damaged: as
/// Debian builds it, an assertion ends the process at the first length that leads out of the file.
struct hbDicomHeader {
  std::string series; ///< Series Instance UID.
  std::int64_t rows = 0, columns = 0, samples = 1, frames = 1, bits = 0;
  bool encapsulated = false;        ///< Compressed.
  std::uint64_t pixelBytes = 0;     ///< Of the pixel data as they are stored.
  glm::dvec3 position{0.0};         ///< Image Position (Patient).
  glm::dvec3 row{1.0, 0.0, 0.0};    ///< Image Orientation (Patient): along a row,
  glm::dvec3 column{0.0, 1.0, 0.0}; ///< and along a column.
  /// Bytes of the pixels, decoded.
  std::uint64_t decodedBytes() const {
    return std::uint64_t(rows * columns * samples * frames) * ((std::uint64_t(bits) + 7) / 8);
  }
};

namespace hb {

/// True for a file with the prefix of DICOM; a file that cannot be read has none.
bool isDicom(const std::filesystem::path& path);

/// Throws hbError for a file that is no DICOM file, is cut or damaged in its structure, or holds no pixels.
hbDicomHeader readDicomHeader(const std::filesystem::path& path);

/// The same from the bytes of the whole file; `path` is for messages.
hbDicomHeader parseDicomHeader(std::span<const std::byte> file, const std::filesystem::path& path);

} // namespace hb
