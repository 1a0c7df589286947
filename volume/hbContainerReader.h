#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "volume/hbContainerFormat.h"
#include "volume/hbProgress.h"

/// Reads the chunks of an `.hbv` file.
///
/// Made for damaged and hostile files: sizes are compared with the file and with the memory limit before anything is
/// allocated, and whatever cannot be right is an hbError that names the file and the place. The file is read with
/// pread, not mapped: one that is shortened meanwhile gives an hbError, too. Const members may be called from several
/// threads at once.
class hbContainerReader {
public:
  /// Opens the file and checks header and table; reads no chunk.
  ///
  /// Chunks of a type outside `knownTypes` are left alone where they are ancillary, and refused (hbError) where they
  /// are critical. `memoryLimit` (bytes) caps the table and the unpacked size of every chunk that is read.
  hbContainerReader(const std::filesystem::path& path, std::vector<hbChunkType> knownTypes, std::uint64_t memoryLimit);
  /// The same for a file that is in memory: `bytes` are all of it, are not copied and must outlive the reader. `name`
  /// stands for the path in messages.
  hbContainerReader(std::span<const std::byte> bytes, const std::string& name, std::vector<hbChunkType> knownTypes,
                    std::uint64_t memoryLimit);
  ~hbContainerReader();
  hbContainerReader(const hbContainerReader&) = delete;
  hbContainerReader& operator=(const hbContainerReader&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const hbContainerHeader& header() const { return header_; }
  std::uint64_t memoryLimit() const { return memoryLimit_; }

  /// All chunks in the order of the file, those of unknown type included.
  std::span<const hbChunkEntry> entries() const { return entries_; }

  /// The entry of that id, or nullptr. O(log entries). Valid as long as the reader.
  const hbChunkEntry* find(const hbChunkId& id) const;

  /// The unpacked bytes of one of entries(). Throws hbError where they cannot be read, are damaged, or would take more
  /// than the memory limit. Costs a read of the stored bytes, two checksums and the unpacking.
  std::vector<std::byte> read(const hbChunkEntry& entry) const;

  /// Hands the stored bytes of one of entries() to `sink`, in order and in pieces of at most 1 MiB, and throws hbError
  /// afterwards where their checksum is wrong.
  void readStored(const hbChunkEntry& entry, const std::function<void(std::span<const std::byte>)>& sink) const;

  /// Reads the whole file: every chunk is unpacked and every checksum and padding byte compared; throws hbError at the
  /// first that is wrong. Returning, it has seen every bit of the file. Of a chunk whose codec is unknown (and whose
  /// type is, too), only the stored bytes are checked.
  void verify(hbProgress& progress = hbProgress::none()) const;

private:
  class StoredBytes;

  void readTable(std::uint64_t size);
  void readAt(std::uint64_t offset, std::span<std::byte> out) const;
  bool knows(hbChunkType type) const;

  std::filesystem::path path_;
  std::vector<hbChunkType> knownTypes_;
  std::uint64_t memoryLimit_;
  int file_ = -1; ///< -1: the file is in bytes_.
  std::span<const std::byte> bytes_;
  hbContainerHeader header_;
  std::vector<hbChunkEntry> entries_;
  std::vector<std::size_t> byId_; ///< Indices of entries_ in the order of their ids.
};
