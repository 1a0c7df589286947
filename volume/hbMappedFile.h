#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace hb {

/// Maps a whole file for reading; the pointer keeps the mapping alive. Nothing is read until it is touched, so a file
/// larger than the memory opens at once. `size` receives its length in bytes.
///
/// Throws hbError where the file is missing, a folder, or cannot be read. A file that another program shortens while it
/// is mapped ends the process with SIGBUS: map inputs, not files being written.
std::shared_ptr<const std::byte> mapFile(const std::filesystem::path& path, std::uint64_t& size);

/// Lets go of the memory that reading from a mapFile() pointer, or one that shares it, has filled so far. What is
/// touched again is read again, so this is safe beside readers. Does nothing for data that are not mapped. One system
/// call; costs a pass over the pages filled.
void releaseMapped(const std::shared_ptr<const std::byte>& data);

} // namespace hb
