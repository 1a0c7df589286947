#include "volume/hbContainerFormat.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include "volume/hbByteReader.h"
#include "volume/hbByteWriter.h"
#include "volume/hbError.h"

namespace {

std::string hex(std::span<const std::byte> bytes) {
  std::vector<int> values(bytes.size());
  std::transform(bytes.begin(), bytes.end(), values.begin(), [](std::byte b) { return std::to_integer<int>(b); });
  return fmt::format("{:02X}", fmt::join(values, " "));
}

bool startsWithMagic(std::span<const std::byte> start) {
  return start.size() >= hb::kContainerMagic.size() &&
         std::ranges::equal(start.first(hb::kContainerMagic.size()), std::as_bytes(std::span(hb::kContainerMagic)));
}

/// Whether the letters of the magic are there but not the bytes around them: line ends converted, the high bit cut off,
/// or its byte re-encoded as two or three of UTF-8.
bool looksTextDamaged(std::span<const std::byte> start) {
  for (std::size_t at = 1; at <= 3 && at + 3 <= start.size(); ++at)
    if (std::ranges::equal(start.subspan(at, 3), std::as_bytes(std::span(hb::kContainerMagic).subspan(1, 3))))
      return true;
  return false;
}

} // namespace

std::uint64_t hb::checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

std::string hb::describe(const hbChunkId& id) {
  return fmt::format("chunk {} (dataset {}, step {}, component {}, key {})", id.type.text(), id.dataset, id.step,
                     id.component, id.key);
}

std::vector<std::byte> hb::encodeContainerHeader(const hbContainerHeader& header) {
  hbByteWriter out;
  out.bytes(std::as_bytes(std::span(kContainerMagic)));
  out.u16(kContainerMajor);
  out.u16(header.minor);
  out.u32(kContainerHeaderSize);
  out.u64(header.features);
  out.u64(header.totalSize);
  out.u64(header.tableOffset);
  out.u64(header.entryCount);
  out.u64(header.tableChecksum);
  std::vector<std::byte> bytes = out.take();
  out.u64(checksum(bytes));
  const std::vector<std::byte> last = out.take();
  bytes.insert(bytes.end(), last.begin(), last.end());
  return bytes;
}

hbContainerHeader hb::decodeContainerHeader(std::span<const std::byte> start, const std::string& what) {
  if (start.empty()) throw hbError(fmt::format("{}: expected an .hbv file, found an empty one", what));
  if (!startsWithMagic(start))
    throw hbError(fmt::format("{}: expected an .hbv file (magic {}), found {}{}", what,
                              hex(std::as_bytes(std::span(kContainerMagic))),
                              hex(start.first(std::min(start.size(), kContainerMagic.size()))),
                              looksTextDamaged(start) ? ": damaged, as by a transfer in text mode" : ""));
  if (start.size() < kContainerHeaderSize)
    throw hbError(fmt::format("{}: expected a header of {} bytes, found a file of {}: truncated", what,
                              kContainerHeaderSize, start.size()));

  hbByteReader in(start.first(kContainerHeaderSize), what + ": header");
  in.bytes(kContainerMagic.size());
  hbContainerHeader header;
  // Before the checksum, as another major version may keep that elsewhere.
  const std::uint16_t major = in.u16();
  header.minor = in.u16();
  if (major != kContainerMajor)
    throw hbError(fmt::format("{}: expected format version {}.x, found {}.{}{}", what, kContainerMajor, major,
                              header.minor, major > kContainerMajor ? ": written by a newer program" : ""));
  const std::uint32_t headerSize = in.u32();
  header.features = in.u64();
  header.totalSize = in.u64();
  header.tableOffset = in.u64();
  header.entryCount = in.u64();
  header.tableChecksum = in.u64();
  const std::uint64_t found = checksum(start.first(in.offset()));
  const std::uint64_t expected = in.u64();
  if (found != expected)
    throw hbError(fmt::format("{}: header: expected checksum {:016x}, found {:016x}: damaged", what, expected, found));
  if (headerSize != kContainerHeaderSize)
    throw hbError(fmt::format("{}: expected a header of {} bytes, found {}", what, kContainerHeaderSize, headerSize));
  if (const std::uint64_t unknown = header.features & ~kContainerFeatures; unknown != 0)
    throw hbError(fmt::format("{}: expected features that format version {}.{} knows, found feature bit {}", what,
                              kContainerMajor, kContainerMinor, std::countr_zero(unknown)));
  return header;
}

std::vector<std::byte> hb::encodeContainerTable(std::span<const hbChunkEntry> entries) {
  hbByteWriter out;
  for (const hbChunkEntry& entry : entries) {
    out.bytes(std::as_bytes(std::span(entry.id.type.code)));
    out.u32(std::uint32_t(entry.kind));
    out.u32(entry.id.dataset);
    out.u32(entry.id.step);
    out.u32(entry.id.component);
    out.zeros(4);
    out.u64(entry.id.key);
    out.u64(entry.offset);
    out.u64(entry.storedSize);
    out.u64(entry.rawSize);
    out.u16(std::uint16_t(entry.codec));
    out.u16(entry.codecVersion);
    out.zeros(4);
    out.u64(entry.storedChecksum);
    out.u64(entry.rawChecksum);
  }
  return out.take();
}

std::vector<hbChunkEntry> hb::decodeContainerTable(std::span<const std::byte> table, std::uint64_t tableOffset,
                                                   const std::string& what) {
  hbByteReader in(table, what + ": table");
  std::vector<hbChunkEntry> entries(table.size() / kContainerEntrySize);
  std::uint64_t next = kContainerHeaderSize; // where the next chunk must begin
  for (hbChunkEntry& entry : entries) {
    std::ranges::copy(in.bytes(4), std::as_writable_bytes(std::span(entry.id.type.code)).begin());
    if (!std::ranges::all_of(entry.id.type.code, [](char c) { return c >= ' ' && c <= '~'; }))
      throw hbError(fmt::format("{}: table: expected a type of four ASCII characters, found {}", what,
                                hex(std::as_bytes(std::span(entry.id.type.code)))));
    const std::uint32_t flags = in.u32();
    entry.kind = hbChunkKind(flags & 1U);
    entry.id.dataset = in.u32();
    entry.id.step = in.u32();
    entry.id.component = in.u32();
    in.zeros(4);
    entry.id.key = in.u64();
    const std::string where = fmt::format("{}: {}", what, describe(entry.id));
    if (flags > 1) throw hbError(fmt::format("{}: expected flags 0 or 1, found {:#x}", where, flags));

    entry.offset = in.u64();
    entry.storedSize = in.u64();
    entry.rawSize = in.u64();
    if (entry.offset != next)
      throw hbError(fmt::format("{}: expected to begin at offset {}, where the one before ends, found {}", where, next,
                                entry.offset));
    if (entry.storedSize > tableOffset - next)
      throw hbError(fmt::format("{}: expected at most {} bytes before the table, found {}", where, tableOffset - next,
                                entry.storedSize));
    next = alignChunk(next + entry.storedSize); // <= tableOffset, which is a multiple, too

    entry.codec = hbCodec(in.u16());
    entry.codecVersion = in.u16();
    in.zeros(4);
    entry.storedChecksum = in.u64();
    entry.rawChecksum = in.u64();
    const bool fits =
        entry.codec == hbCodec::stored ? entry.storedSize == entry.rawSize : entry.storedSize < entry.rawSize;
    if (!fits)
      throw hbError(fmt::format("{}: expected {} {} bytes in the file, found {}", where,
                                entry.codec == hbCodec::stored ? "exactly" : "fewer than", entry.rawSize,
                                entry.storedSize));
  }
  in.finish();
  if (next != tableOffset)
    throw hbError(
        fmt::format("{}: expected the table at offset {}, where the chunks end, found {}", what, next, tableOffset));

  std::vector<hbChunkId> ids(entries.size());
  std::ranges::transform(entries, ids.begin(), &hbChunkEntry::id);
  std::ranges::sort(ids);
  if (const auto twice = std::ranges::adjacent_find(ids); twice != ids.end())
    throw hbError(fmt::format("{}: {}: expected once, found twice", what, describe(*twice)));
  return entries;
}
