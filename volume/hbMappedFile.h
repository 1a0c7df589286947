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

/// Tells the system that the bytes of a mapping will be read here and there, so that it reads no neighbours ahead. No
/// effect on bytes that mapFile() did not map. O(1).
void adviseScatteredReads(const std::shared_ptr<const std::byte>& bytes);

/// Gives the pages of a mapping that were read so far back to the system; they are read again when they are touched. No
/// effect on bytes that mapFile() did not map.
void releasePages(const std::shared_ptr<const std::byte>& bytes);

/// The same for `count` bytes from `first` on, counted from where `bytes` points to, and what the system mapped around
/// them: cheaper than all of a large file.
void releasePages(const std::shared_ptr<const std::byte>& bytes, std::uint64_t first, std::uint64_t count);

} // namespace hb
