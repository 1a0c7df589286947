#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "volume/coding/hbByteCodec.h"

// The parts of the `.hbv` file that its writer and reader share. doc/formats.md describes them byte by byte.

/// The four characters that say what a chunk holds, printable ASCII: hbChunkType{"GEOM"}.
struct hbChunkType {
  std::array<char, 4> code{};

  constexpr hbChunkType() = default;
  constexpr hbChunkType(const char (&text)[5]) : code{text[0], text[1], text[2], text[3]} {}
  std::string text() const { return {code.data(), code.size()}; }
  // clang-tidy 14 takes the 0 inside a defaulted <=> for a pointer.
  auto operator<=>(const hbChunkType&) const = default; // NOLINT(modernize-use-nullptr)
};

/// What names a chunk in its file; no two chunks have the same. Numbers that a type has no use for are 0.
struct hbChunkId {
  hbChunkType type;
  std::uint32_t dataset = 0;
  std::uint32_t step = 0;
  std::uint32_t component = 0;
  std::uint64_t key = 0;                              ///< Meaning given by the type: a page, a node, a running number.
  auto operator<=>(const hbChunkId&) const = default; // NOLINT(modernize-use-nullptr)
};

/// Whether a reader that does not know a chunk's type may go on without it.
enum class hbChunkKind : std::uint32_t { ancillary = 0, critical = 1 };

/// One line of the table at the end of the file.
struct hbChunkEntry {
  hbChunkId id;
  hbChunkKind kind = hbChunkKind::ancillary;
  std::uint64_t offset = 0;     ///< From the beginning of the file, a multiple of hb::kContainerAlignment.
  std::uint64_t storedSize = 0; ///< Bytes in the file.
  std::uint64_t rawSize = 0;    ///< Bytes when unpacked.
  hbCodec codec = hbCodec::stored;
  std::uint16_t codecVersion = hb::kCodecVersion;
  std::uint64_t storedChecksum = 0; ///< XXH3-64 of the bytes in the file.
  std::uint64_t rawChecksum = 0;    ///< XXH3-64 of the unpacked bytes.
  bool operator==(const hbChunkEntry&) const = default;
};

struct hbContainerHeader {
  std::uint16_t minor = 0;    ///< Of the version; the major number is that of this code.
  std::uint64_t features = 0; ///< Bits of what a reader must know beyond the version.
  std::uint64_t totalSize = 0;
  std::uint64_t tableOffset = 0;
  std::uint64_t entryCount = 0;
  std::uint64_t tableChecksum = 0;
  bool operator==(const hbContainerHeader&) const = default;
};

namespace hb {

inline constexpr std::array<std::uint8_t, 8> kContainerMagic{0x89, 'H', 'B', 'V', '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint16_t kContainerMajor = 1;
inline constexpr std::uint16_t kContainerMinor = 0;
/// The feature bits this code knows: none so far.
inline constexpr std::uint64_t kContainerFeatures = 0;
inline constexpr std::uint64_t kContainerHeaderSize = 64;
inline constexpr std::uint64_t kContainerEntrySize = 80;
inline constexpr std::uint64_t kContainerAlignment = 64;

/// The next multiple of kContainerAlignment; below 2^64 - 64.
constexpr std::uint64_t alignChunk(std::uint64_t offset) {
  return (offset + kContainerAlignment - 1) / kContainerAlignment * kContainerAlignment;
}

/// XXH3-64 with seed 0.
std::uint64_t checksum(std::span<const std::byte> bytes);

/// "chunk GEOM (dataset 0, step 0, component 0, key 0)".
std::string describe(const hbChunkId& id);

/// kContainerHeaderSize bytes, checksum included.
std::vector<std::byte> encodeContainerHeader(const hbContainerHeader& header);

/// Reads the header from the first bytes of a file (kContainerHeaderSize of them, or all that a shorter file has).
/// Throws hbError, beginning with `what`, for a file of another kind, one damaged by a transfer in text mode, a
/// truncated header, a newer major version, a wrong checksum and unknown feature bits.
hbContainerHeader decodeContainerHeader(std::span<const std::byte> start, const std::string& what);

/// kContainerEntrySize bytes an entry, one after the other.
std::vector<std::byte> encodeContainerTable(std::span<const hbChunkEntry> entries);

/// Reads and checks a table whose checksum was found right. Throws hbError, beginning with `what`, unless the chunks
/// follow one another from the header to `tableOffset` with the least padding, sizes fit their codec, no id occurs
/// twice and reserved fields are zero.
std::vector<hbChunkEntry> decodeContainerTable(std::span<const std::byte> table, std::uint64_t tableOffset,
                                               const std::string& what);

} // namespace hb
