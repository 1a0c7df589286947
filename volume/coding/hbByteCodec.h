#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// How the bytes of a chunk are packed. The numbers are those of the `.hbv` file; others may come from newer ones.
enum class hbCodec : std::uint16_t {
  stored = 0,     ///< As they are.
  zstd = 1,       ///< One zstd frame (RFC 8878).
  planesZstd = 2, ///< Byte planes of 4-byte elements, then one zstd frame; see hb::encodeBytes. For arrays of float.
};

namespace hb {

/// The version of every codec above, as written into files.
inline constexpr std::uint16_t kCodecVersion = 1;

/// Packs `bytes`; nothing where the packed form would not be smaller, and for hbCodec::stored.
///
/// planesZstd cuts the bytes into blocks of 512 KiB (the last may be shorter) and writes of each block the first bytes
/// of all 4-byte elements, then the second, third and fourth ones, then the at most three bytes left over. A plane of a
/// whole block is 128 KiB, the largest block of zstd, so that each zstd block holds bytes of one significance and has
/// statistics of its own.
///
/// The same bytes give the same result with the same version of zstd, whatever the machine and number of threads: the
/// level is fixed and one thread packs. Needs memory for another bytes.size() and a few MiB.
std::optional<std::vector<std::byte>> encodeBytes(hbCodec codec, std::span<const std::byte> bytes);

/// Hands out the packed bytes piece by piece; an empty piece says that there are no more. A piece stays valid until the
/// next call.
using hbByteSource = std::function<std::span<const std::byte>()>;

/// Unpacks what encodeBytes made (or, for hbCodec::stored, copies it): exactly `rawSize` bytes.
///
/// Damaged and hostile input is expected: the packed bytes pass in bounded steps, and beyond the result, which is
/// allocated after rawSize was compared with `memoryLimit` (bytes), at most about 10 MiB are used. Throws hbError,
/// beginning with `what`, for an unknown codec or version, a rawSize above the limit, a damaged stream, one that gives
/// fewer or more bytes than rawSize, and packed bytes after the end of the stream.
std::vector<std::byte> decodeBytes(hbCodec codec, std::uint16_t version, const hbByteSource& source,
                                   std::uint64_t rawSize, std::uint64_t memoryLimit, const std::string& what);

/// Whether decodeBytes knows the codec in that version.
bool canDecode(hbCodec codec, std::uint16_t version);

} // namespace hb
