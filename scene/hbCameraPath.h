#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/hbCamera.h"

/// Cameras one after another, of a series of pictures.
namespace hb {

constexpr std::size_t kMostCameras = 100000;

/// Once around the target in `count` equal steps, from `first` on, about the world's z axis, counter-clockwise as seen
/// from above, as azimuths go; about `up` where that is level. 1 to kMostCameras, or hbError.
std::vector<hbCamera> orbit(const hbCamera& first, int count);

/// A JSON object with the cameras as scenes have them; equal cameras give equal text. pathFromJson() gives back the
/// very same numbers. Throws hbError for a camera that is not valid.
std::string toJson(std::span<const hbCamera> cameras);

/// Reads what toJson() writes, 1 to kMostCameras cameras; throws hbError as sceneFromJson() does.
std::vector<hbCamera> pathFromJson(const std::string& text, const std::string& name);

/// From a file of at most 64 MB; throws hbError as pathFromJson() does.
std::vector<hbCamera> loadPath(const std::filesystem::path& path);

/// The file appears whole or not at all.
void savePath(std::span<const hbCamera> cameras, const std::filesystem::path& path);

} // namespace hb
