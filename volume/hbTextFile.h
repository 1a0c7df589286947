#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Small text files, whole, and what is shown of them. Not installed.
namespace hb {

/// Throws hbError where the file cannot be read, or naming `what` ("a scene") where it is larger than `maxBytes`.
std::string loadText(const std::filesystem::path& path, std::uint64_t maxBytes, std::string_view what);

/// The file appears whole or not at all; throws hbError where it cannot be written.
void saveText(std::string_view text, const std::filesystem::path& path);

/// Text from outside for use in a message: printable ASCII and not long.
std::string excerpt(std::string_view text);

} // namespace hb
