#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hb {

/// Base 64 with padding (RFC 4648, section 4).
std::string base64(std::string_view bytes);

/// A file as a "data:" URI of that media type ("image/png"). Throws hbError where it cannot be read.
std::string dataUri(const std::filesystem::path& path, std::string_view mediaType);

} // namespace hb
