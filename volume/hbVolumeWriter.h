#pragma once

#include <filesystem>
#include <string_view>

#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

namespace hb {

/// The formats that writeVolume() and hbVolumeStream know.
inline constexpr std::string_view kWritableVolumes = ".nrrd, .vti or .raw";

/// Writes all samples of a volume; the extension chooses the format (see hbVolumeStream). Needs the memory of one row.
///
/// A slope other than 1 or an intercept other than 0 is applied: the file holds the data values, as float64 where the
/// samples are int32, uint32 or float64, else as float32.
void writeVolume(const hbVolume& volume, const std::filesystem::path& path, hbProgress& progress = hbProgress::none());

} // namespace hb
