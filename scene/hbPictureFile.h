#pragma once

#include <filesystem>
#include <variant>

#include "scene/hbImage8.h"
#include "scene/hbPicture.h"

/// Pictures in files: OpenEXR for floats, PNG for what is looked at. Files are written whole or not at all, and equal
/// pictures give equal bytes. Readers throw hbError for files that are missing, damaged or of another kind, and check
/// sizes before they allocate: at most hbScene::kMaxPictureSide pixels a side.
namespace hb {

/// Writes every channel as 32-bit FLOAT (its name as it is, at most 255 bytes), ZIP-compressed, top row first, and the
/// metadata as string attributes. Throws hbError for a picture that is not valid or metadata whose keys do not begin
/// with hbPicture::kMetadataPrefix.
void writeExr(const hbPicture& picture, const std::filesystem::path& path);

/// Reads a single-part OpenEXR file, scan lines or tiles, at most 32 channels and 2^30 values; HALF and UINT channels
/// are converted to float. The picture is the data window; its metadata are the string attributes whose names begin
/// with hbPicture::kMetadataPrefix. Deep, multi-part and subsampled files are refused.
hbPicture readExr(const std::filesystem::path& path);

/// Writes 8-bit RGB, marked as sRGB. Throws hbError where a side is outside 1 to hbScene::kMaxPictureSide or the pixels
/// do not fit the sides.
void writePng(const hbImage8& image, const std::filesystem::path& path);

/// Reads any PNG as 8-bit sRGB: gray becomes RGB, 16 bits are rounded to 8, and what is transparent shows black behind.
hbImage8 readPng(const std::filesystem::path& path);

/// Reads a picture by the extension of its name, .exr or .png in either case.
std::variant<hbPicture, hbImage8> readPicture(const std::filesystem::path& path);

} // namespace hb
