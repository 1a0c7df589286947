#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "volume/hbSampleType.h"
#include "volume/hbVolume.h"

/// How the samples lie in a file without a header.
struct hbRawLayout {
  enum class Interleaving : std::uint8_t {
    packed, ///< The components of a sample side by side.
    planar  ///< One component of all samples, then the next.
  };

  hbSize3 size{1, 1, 1}; ///< Samples along the volume's x, y, z, whatever the axis order.
  hbSampleType type = hbSampleType::uint8;
  bool bigEndian = false;
  std::string axisOrder = "xyz"; ///< The volume's axes from the file's fastest to its slowest.
  std::uint64_t offset = 0;      ///< Bytes before the first sample.
  int components = 1;
  Interleaving interleaving = Interleaving::packed;
  glm::dvec3 spacing{1.0}; ///< Along x, y, z; positive.
};

namespace hb {

/// The layout that the Open SciVis convention, `name_256x256x128_uint16.raw` (x fastest, little-endian), puts into a
/// file's name; nothing for any other name. Throws hbError where the sizes do not fit 64 bits.
std::optional<hbRawLayout> rawLayoutFromName(const std::filesystem::path& path);

/// `stem_256x256x128_uint16.raw`.
std::string rawFileName(const std::string& stem, const hbSize3& size, hbSampleType type);

/// Maps a raw file: nothing is read or copied, so a file larger than the memory opens at once.
///
/// Throws hbError where the file is missing, the layout is none, or the file's size is not exactly
/// offset + samples * components * bytes.
hbVolume openRawFile(const std::filesystem::path& path, const hbRawLayout& layout);

} // namespace hb
