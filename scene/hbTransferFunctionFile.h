#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scene/hbTransferFunction.h"

/// Transfer functions as files: ParaView's JSON colour maps, read and written, and plain tables, read.
/// doc/transfer-functions.md lists the keys.
namespace hb {

/// The colour maps as a JSON array that ParaView imports; every number is read back as it is. The two keys that
/// ParaView does not know (`OpacityOutside`, `Relative`) it ignores, and so it does `ScalarOpacityUnitDistance`, which
/// there belongs to the picture.
std::string toJson(std::span<const hbTransferFunction> functions);

/// Reads ParaView's JSON: an array of colour maps, or one alone. Where `only` is not empty, those of that name; others
/// are not looked at. Keys that say nothing about colours and opacities of values are ignored (Creator, License, ...);
/// maps of indexed colours and of logarithmic scale, and other colour spaces, throw hbError: one line that begins with
/// `source`, names the map and gives the key. No map at all throws too.
std::vector<hbTransferFunction> transferFunctionsFromJson(const std::string& text, const std::string& source,
                                                          const std::string& only = "");

/// Reads a plain table: lines `value red green blue opacity`, colours coded sRGB and everything but values in [0,1],
/// to be interpolated linearly. What follows a # is a comment. Throws hbError naming `source` and the line.
hbTransferFunction transferFunctionFromTable(const std::string& text, const std::string& source);

/// Reads a file of at most 1 MB of either kind: JSON where its first character is [ or {.
std::vector<hbTransferFunction> loadTransferFunctions(const std::filesystem::path& path, const std::string& only = "");

/// Writes toJson(functions); the file appears whole or not at all. Throws hbError where it would have more than 1 MB.
void saveTransferFunctions(std::span<const hbTransferFunction> functions, const std::filesystem::path& path);

} // namespace hb
