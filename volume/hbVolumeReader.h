#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

#include "volume/hbProgress.h"
#include "volume/hbRawFile.h"
#include "volume/hbVolume.h"

struct hbReadOptions {
  /// The most bytes that the samples may take; a file that needs more is refused before anything is allocated. Samples
  /// that are mapped take none. (ITK may need as much again while it decodes NIfTI.)
  std::uint64_t memoryLimit = std::numeric_limits<std::uint64_t>::max();
  /// Given: the file is raw, whatever its name. Otherwise a `.raw` file's name must say its layout.
  std::optional<hbRawLayout> raw;
  /// The DICOM series to read of a folder that holds several: its UID, or the beginning of it.
  std::string series;
};

namespace hb {

/// Reads a volume file, or a folder of DICOM slices; doc/files.md says which formats there are, and how each one's
/// coordinates, centring and types become those of hbVolume. Images of one or two dimensions get flat axes.
///
/// Raw files, and NRRD and MetaImage files with raw encoding in one file, are mapped instead of read: they open at
/// once and take no memory.
///
/// Throws hbError, in one line, for a file that is missing, of an unknown format, damaged or too short, or larger than
/// the memory limit; sizes are checked against the file before anything is allocated. hbCancelled where `progress` is.
hbVolume readVolume(const std::filesystem::path& path, const hbReadOptions& options = {},
                    hbProgress& progress = hbProgress::none());

} // namespace hb
