#include "volume/hbContainerReader.h"

#include <algorithm>
#include <cerrno>
#include <memory>
#include <new>
#include <numeric>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "volume/hbError.h"

namespace {

constexpr std::uint64_t kPiece = std::uint64_t{1} << 20U;

std::string reason() { return std::generic_category().message(errno); }

} // namespace

/// The stored bytes of a chunk in pieces, with their checksum.
class hbContainerReader::StoredBytes {
public:
  StoredBytes(const hbContainerReader& reader, const hbChunkEntry& entry)
      : reader_(reader), entry_(entry), piece_(std::min(kPiece, entry.storedSize)), hash_(XXH3_createState()) {
    if (!hash_) throw std::bad_alloc();
    XXH3_64bits_reset(hash_.get());
  }

  /// The next piece, empty at the end. Throws hbError at the end where the checksum is wrong.
  std::span<const std::byte> next() {
    const std::uint64_t count = std::min<std::uint64_t>(piece_.size(), entry_.storedSize - done_);
    const std::span<std::byte> piece = std::span(piece_).first(count);
    if (count > 0) {
      reader_.readAt(entry_.offset + done_, piece);
      XXH3_64bits_update(hash_.get(), piece.data(), piece.size());
      done_ += count;
    } else if (const std::uint64_t found = XXH3_64bits_digest(hash_.get()); found != entry_.storedChecksum) {
      throw hbError(fmt::format("{}: {}: expected checksum {:016x}, found {:016x}: damaged", reader_.path_.string(),
                                hb::describe(entry_.id), entry_.storedChecksum, found));
    }
    return piece;
  }

private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };

  const hbContainerReader& reader_;
  const hbChunkEntry& entry_;
  std::vector<std::byte> piece_;
  std::unique_ptr<XXH3_state_t, Free> hash_;
  std::uint64_t done_ = 0;
};

hbContainerReader::hbContainerReader(const std::filesystem::path& path, std::vector<hbChunkType> knownTypes,
                                     std::uint64_t memoryLimit)
    : path_(path), knownTypes_(std::move(knownTypes)), memoryLimit_(memoryLimit) {
  const std::string what = path.string();
  // O_NONBLOCK has no effect on files, but keeps a named pipe from waiting for a writer.
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) throw hbError(fmt::format("{}: cannot be read: {}", what, reason()));
  try {
    struct stat status {};
    if (::fstat(file_, &status) != 0) throw hbError(fmt::format("{}: cannot be read: {}", what, reason()));
    if (!S_ISREG(status.st_mode))
      throw hbError(fmt::format("{}: expected an .hbv file, found {}", what,
                                S_ISDIR(status.st_mode) ? "a folder" : "a device or pipe"));
    readTable(std::uint64_t(status.st_size));
  } catch (...) {
    ::close(file_);
    throw;
  }
}

hbContainerReader::hbContainerReader(std::span<const std::byte> bytes, const std::string& name,
                                     std::vector<hbChunkType> knownTypes, std::uint64_t memoryLimit)
    : path_(name), knownTypes_(std::move(knownTypes)), memoryLimit_(memoryLimit), bytes_(bytes) {
  readTable(bytes.size());
}

/// Header and table of a file of `size` bytes.
void hbContainerReader::readTable(std::uint64_t size) {
  const std::string what = path_.string();
  std::vector<std::byte> start(std::min(size, hb::kContainerHeaderSize));
  readAt(0, start);
  header_ = hb::decodeContainerHeader(start, what);

  const auto& [minor, features, totalSize, tableOffset, entryCount, tableChecksum] = header_;
  if (totalSize != size)
    throw hbError(fmt::format("{}: expected {} bytes as its header says, found {}: {}", what, totalSize, size,
                              size < totalSize ? "truncated" : "something was added"));
  if (tableOffset % hb::kContainerAlignment != 0 || tableOffset < hb::kContainerHeaderSize || tableOffset > size)
    throw hbError(fmt::format("{}: expected the table at a multiple of {} from {} to {}, found offset {}", what,
                              hb::kContainerAlignment, hb::kContainerHeaderSize, size, tableOffset));
  const std::uint64_t tableSize = size - tableOffset;
  if (tableSize % hb::kContainerEntrySize != 0 || entryCount != tableSize / hb::kContainerEntrySize)
    throw hbError(fmt::format("{}: expected a table of {} entries of {} bytes at the end, found {} bytes", what,
                              entryCount, hb::kContainerEntrySize, tableSize));
  if (tableSize > memoryLimit_)
    throw hbError(fmt::format("{}: table: expected at most {} bytes of memory to be needed, found {}", what,
                              memoryLimit_, tableSize));
  std::vector<std::byte> table(tableSize);
  readAt(tableOffset, table);
  if (const std::uint64_t found = hb::checksum(table); found != tableChecksum)
    throw hbError(
        fmt::format("{}: table: expected checksum {:016x}, found {:016x}: damaged", what, tableChecksum, found));
  entries_ = hb::decodeContainerTable(table, tableOffset, what);

  for (const hbChunkEntry& entry : entries_)
    if (entry.kind == hbChunkKind::critical && !knows(entry.id.type))
      throw hbError(fmt::format("{}: {}: needed to read the file (format version {}.{}), but of a type unknown here",
                                what, hb::describe(entry.id), hb::kContainerMajor, minor));
  byId_.resize(entries_.size());
  std::iota(byId_.begin(), byId_.end(), std::size_t{0});
  std::ranges::sort(byId_, {}, [this](std::size_t i) { return entries_[i].id; });
}

hbContainerReader::~hbContainerReader() {
  if (file_ >= 0) ::close(file_);
}

void hbContainerReader::readAt(std::uint64_t offset, std::span<std::byte> out) const {
  if (file_ < 0) { // all offsets were compared with its size
    std::ranges::copy(bytes_.subspan(offset, out.size()), out.begin());
    return;
  }
  while (!out.empty()) {
    const ssize_t count = ::pread(file_, out.data(), out.size(), off_t(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw hbError(fmt::format("{}: cannot be read at offset {}: {}", path_.string(), offset, reason()));
    if (count == 0)
      throw hbError(fmt::format("{}: expected {} more bytes at offset {}, found the end: shortened while being read",
                                path_.string(), out.size(), offset));
    out = out.subspan(std::size_t(count));
    offset += std::uint64_t(count);
  }
}

bool hbContainerReader::knows(hbChunkType type) const {
  return std::ranges::find(knownTypes_, type) != knownTypes_.end();
}

const hbChunkEntry* hbContainerReader::find(const hbChunkId& id) const {
  const auto at = std::ranges::lower_bound(byId_, id, {}, [this](std::size_t i) { return entries_[i].id; });
  return at != byId_.end() && entries_[*at].id == id ? &entries_[*at] : nullptr;
}

std::vector<std::byte> hbContainerReader::read(const hbChunkEntry& entry) const {
  const std::string what = fmt::format("{}: {}", path_.string(), hb::describe(entry.id));
  StoredBytes stored(*this, entry);
  std::vector<std::byte> raw = hb::decodeBytes(
      entry.codec, entry.codecVersion, [&] { return stored.next(); }, entry.rawSize, memoryLimit_, what);
  if (const std::uint64_t found = hb::checksum(raw); found != entry.rawChecksum)
    throw hbError(fmt::format("{}: expected checksum {:016x} when unpacked, found {:016x}: damaged", what,
                              entry.rawChecksum, found));
  return raw;
}

void hbContainerReader::readStored(const hbChunkEntry& entry,
                                   const std::function<void(std::span<const std::byte>)>& sink) const {
  StoredBytes stored(*this, entry);
  for (auto piece = stored.next(); !piece.empty(); piece = stored.next()) sink(piece);
}

void hbContainerReader::verify(hbProgress& progress) const {
  progress.begin("verifying", std::int64_t(header_.totalSize), "bytes");
  std::vector<std::byte> padding;
  for (const hbChunkEntry& entry : entries_) {
    if (knows(entry.id.type) || hb::canDecode(entry.codec, entry.codecVersion))
      read(entry);
    else
      readStored(entry, [](std::span<const std::byte>) {});
    const std::uint64_t end = entry.offset + entry.storedSize;
    padding.resize(hb::alignChunk(end) - end);
    readAt(end, padding);
    for (std::size_t i = 0; i < padding.size(); ++i)
      if (padding[i] != std::byte{0})
        throw hbError(fmt::format("{}: padding after {}: expected a zero byte at offset {}, found {}", path_.string(),
                                  hb::describe(entry.id), end + i, std::to_integer<int>(padding[i])));
    progress.advance(std::int64_t(hb::alignChunk(end) - entry.offset));
  }
}
