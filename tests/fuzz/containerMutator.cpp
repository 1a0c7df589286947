// Mutations of `.hbv` files that get past the checksums: chunks are changed, dropped, copied and moved, and the file is
// laid out anew around them; or any byte is changed and the checksums made right again. A quarter of the mutations
// leave them wrong.

#include <algorithm>
#include <cstring>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "sparsegrid/hbSparseGridFile.h"
#include "tests/fuzz/fuzz.h"
#include "volume/coding/hbByteCodec.h"
#include "volume/hbContainerFormat.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

namespace {

using Bytes = std::vector<std::byte>;
using Random = std::minstd_rand;

constexpr std::uint64_t kMaxRaw = std::uint64_t{1} << 16;

// Offsets in header and table, see doc/formats.md.
constexpr std::size_t kTotalSizeAt = 24, kTableOffsetAt = 32, kEntryCountAt = 40, kTableChecksumAt = 48,
                      kHeaderChecksumAt = 56;
constexpr std::size_t kOffsetAt = 32, kStoredSizeAt = 40, kRawSizeAt = 48, kCodecAt = 56, kStoredChecksumAt = 64,
                      kRawChecksumAt = 72;

template <class T>
T load(const Bytes& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <class T>
void store(Bytes& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// The raw bytes of stored ones, or nothing.
std::optional<Bytes> unpacked(hbCodec codec, std::span<const std::byte> stored, std::uint64_t rawSize) {
  try {
    bool given = false;
    const auto source = [&] { return std::exchange(given, true) ? std::span<const std::byte>() : stored; };
    return hb::decodeBytes(codec, hb::kCodecVersion, source, rawSize, kMaxRaw, "chunk");
  } catch (const hbError&) {
    return std::nullopt;
  }
}

/// Mutates bytes within `maxSize`.
void mutate(Bytes& bytes, std::size_t maxSize) {
  const std::size_t size = bytes.size();
  bytes.resize(std::max(maxSize, size));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
}

/// Makes sizes and checksums right for whatever entries there are.
void restamp(Bytes& file) {
  if (file.size() < hb::kContainerHeaderSize) return;
  const std::uint64_t table = load<std::uint64_t>(file, kTableOffsetAt);
  if (table < hb::kContainerHeaderSize || table > file.size()) return;
  file.resize(file.size() - (file.size() - table) % hb::kContainerEntrySize);
  for (std::size_t at = table; at < file.size(); at += hb::kContainerEntrySize) {
    const auto offset = load<std::uint64_t>(file, at + kOffsetAt), size = load<std::uint64_t>(file, at + kStoredSizeAt);
    if (offset > file.size() || size > file.size() - offset) continue;
    const auto stored = std::span<const std::byte>(file).subspan(offset, size);
    store(file, at + kStoredChecksumAt, hb::checksum(stored));
    if (const auto raw = unpacked(hbCodec(load<std::uint16_t>(file, at + kCodecAt)), stored,
                                  load<std::uint64_t>(file, at + kRawSizeAt)))
      store(file, at + kRawChecksumAt, hb::checksum(*raw));
  }
  store<std::uint64_t>(file, kTotalSizeAt, file.size());
  store<std::uint64_t>(file, kEntryCountAt, (file.size() - table) / hb::kContainerEntrySize);
  store(file, kTableChecksumAt, hb::checksum(std::span<const std::byte>(file).subspan(table)));
  store(file, kHeaderChecksumAt, hb::checksum(std::span<const std::byte>(file).first(kHeaderChecksumAt)));
}

struct Chunk {
  hbChunkEntry entry;
  Bytes raw;
};

/// The chunks that can be unpacked, checksums aside.
std::vector<Chunk> split(const Bytes& file) {
  std::vector<Chunk> chunks;
  if (file.size() < hb::kContainerHeaderSize) return chunks;
  const std::uint64_t table = load<std::uint64_t>(file, kTableOffsetAt);
  if (table > file.size()) return chunks;
  try {
    const auto entries = hb::decodeContainerTable(std::span<const std::byte>(file).subspan(table), table, "file");
    for (const hbChunkEntry& entry : entries)
      if (auto raw = unpacked(entry.codec, std::span<const std::byte>(file).subspan(entry.offset, entry.storedSize),
                              entry.rawSize))
        chunks.push_back({entry, std::move(*raw)});
  } catch (const hbError&) {
    chunks.clear();
  }
  return chunks;
}

/// A right file of these chunks, packed as their entries say where that makes them smaller.
Bytes layOut(const std::vector<Chunk>& chunks) {
  Bytes file(hb::kContainerHeaderSize);
  std::vector<hbChunkEntry> entries;
  for (const Chunk& chunk : chunks) {
    hbChunkEntry entry = chunk.entry;
    const auto packed = hb::encodeBytes(entry.codec, chunk.raw);
    const Bytes& stored = packed ? *packed : chunk.raw;
    if (!packed) entry.codec = hbCodec::stored;
    entry.offset = file.size();
    entry.storedSize = stored.size();
    entry.rawSize = chunk.raw.size();
    entry.storedChecksum = hb::checksum(stored);
    entry.rawChecksum = hb::checksum(chunk.raw);
    file.insert(file.end(), stored.begin(), stored.end());
    file.resize(hb::alignChunk(file.size()));
    entries.push_back(entry);
  }
  const Bytes table = hb::encodeContainerTable(entries);
  hbContainerHeader header{hb::kContainerMinor, 0, file.size() + table.size(), file.size(), entries.size(),
                           hb::checksum(table)};
  const Bytes start = hb::encodeContainerHeader(header);
  std::copy(start.begin(), start.end(), file.begin());
  file.insert(file.end(), table.begin(), table.end());
  return file;
}

/// Changes one chunk, or which chunks there are.
void mutateChunks(std::vector<Chunk>& chunks, Random& random, std::size_t maxSize) {
  const std::size_t i = random() % chunks.size();
  Chunk& chunk = chunks[i];
  const auto types = hbSparseGridFile::chunkTypes();
  switch (random() % 16) {
  case 0:
    chunks.erase(chunks.begin() + std::ptrdiff_t(i));
    break;
  case 1: {
    Chunk copy = chunk;
    ++copy.entry.id.component;
    chunks.push_back(std::move(copy));
    break;
  }
  case 2:
    std::swap(chunk, chunks[random() % chunks.size()]);
    break;
  case 3:
    chunk.entry.id.type = types[random() % types.size()];
    break;
  case 4:
    chunk.entry.codec = hbCodec(random() % 3);
    break;
  default:
    mutate(chunk.raw, maxSize);
    break;
  }
}

} // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned int seed) {
  Random random(seed);
  const unsigned way = random() % 4;
  if (way == 0) return LLVMFuzzerMutate(data, size, maxSize);
  const auto given = std::as_bytes(std::span(data, size));
  Bytes file(given.begin(), given.end());
  std::vector<Chunk> chunks = way == 1 ? std::vector<Chunk>() : split(file);
  if (chunks.empty()) {
    mutate(file, maxSize);
    restamp(file);
  } else {
    for (unsigned count = 1 + random() % 3; count > 0 && !chunks.empty(); --count)
      mutateChunks(chunks, random, maxSize / 2);
    file = layOut(chunks);
  }
  if (file.size() > maxSize) return LLVMFuzzerMutate(data, size, maxSize);
  std::memcpy(data, file.data(), file.size());
  return file.size();
}
