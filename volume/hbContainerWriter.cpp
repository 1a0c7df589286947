#include "volume/hbContainerWriter.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "volume/hbContainerReader.h"
#include "volume/hbError.h"

hbContainerWriter::hbContainerWriter(const std::filesystem::path& target) : target_(target) { open(); }

hbContainerWriter::hbContainerWriter(const hbContainerReader& old, hbProgress& progress)
    : target_(old.path()), minor_(std::max(hb::kContainerMinor, old.header().minor)), features_(old.header().features) {
  open();
  try {
    progress.begin("copying", std::int64_t(old.header().totalSize), "bytes");
    for (const hbChunkEntry& entry : old.entries()) {
      hbChunkEntry copy = entry;
      copy.offset = position_;
      old.readStored(entry, [&](std::span<const std::byte> piece) {
        write(piece);
        progress.advance(std::int64_t(piece.size()));
      });
      pad();
      entries_.push_back(copy);
      ids_.insert(copy.id);
    }
  } catch (...) {
    closeFile();
    throw;
  }
}

hbContainerWriter hbContainerWriter::appendTo(const std::filesystem::path& target, std::vector<hbChunkType> knownTypes,
                                              hbProgress& progress) {
  // No chunk is unpacked, so there is nothing to limit but the table, which is no larger than the file.
  const hbContainerReader old(target, std::move(knownTypes), std::numeric_limits<std::uint64_t>::max());
  return {old, progress};
}

hbContainerWriter::~hbContainerWriter() { closeFile(); }

void hbContainerWriter::open() {
  output_ = std::make_unique<hbOutputFile>(target_);
  file_ = ::open(output_->path().c_str(), O_WRONLY | O_CLOEXEC);
  if (file_ < 0) fail();
  // Zeros until commit(): not even the temporary file is ever a readable, incomplete container.
  write(std::array<std::byte, hb::kContainerHeaderSize>{});
}

void hbContainerWriter::closeFile() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void hbContainerWriter::fail() {
  const std::string reason = std::generic_category().message(errno);
  closeFile();
  output_.reset();
  throw hbError(fmt::format("{}: cannot be written: {}", target_.string(), reason));
}

void hbContainerWriter::expectOpen() const {
  if (!output_)
    throw hbError(fmt::format("{}: expected a file being written, found one committed or failed", target_.string()));
}

void hbContainerWriter::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file_, bytes.data(), bytes.size(), off_t(position_));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    bytes = bytes.subspan(std::size_t(count));
    position_ += std::uint64_t(count);
  }
}

void hbContainerWriter::pad() {
  constexpr std::array<std::byte, hb::kContainerAlignment> kZeros{};
  write(std::span(kZeros).first(hb::alignChunk(position_) - position_));
}

void hbContainerWriter::add(const hbChunkId& id, hbChunkKind kind, std::span<const std::byte> bytes, hbCodec codec) {
  expectOpen();
  if (!std::ranges::all_of(id.type.code, [](char c) { return c >= ' ' && c <= '~'; }))
    throw hbError(fmt::format("{}: expected a chunk type of four printable ASCII characters", target_.string()));
  if (ids_.contains(id))
    throw hbError(fmt::format("{}: {}: expected once, found twice", target_.string(), hb::describe(id)));

  const auto packed = hb::encodeBytes(codec, bytes);
  const std::span<const std::byte> stored = packed ? std::span<const std::byte>(*packed) : bytes;
  hbChunkEntry entry;
  entry.id = id;
  entry.kind = kind;
  entry.offset = position_;
  entry.storedSize = stored.size();
  entry.rawSize = bytes.size();
  entry.codec = packed ? codec : hbCodec::stored;
  entry.rawChecksum = hb::checksum(bytes);
  entry.storedChecksum = packed ? hb::checksum(stored) : entry.rawChecksum;
  ids_.insert(id);
  entries_.push_back(entry);
  write(stored);
  pad();
}

void hbContainerWriter::commit() {
  expectOpen();
  const std::vector<std::byte> table = hb::encodeContainerTable(entries_);
  hbContainerHeader header;
  header.minor = minor_;
  header.features = features_;
  header.tableOffset = position_;
  header.entryCount = entries_.size();
  header.tableChecksum = hb::checksum(table);
  write(table);
  header.totalSize = position_;
  position_ = 0;
  write(hb::encodeContainerHeader(header));
  const int file = std::exchange(file_, -1);
  if (::close(file) != 0) fail();
  const std::unique_ptr<hbOutputFile> output = std::move(output_); // gone whether or not the renaming succeeds
  output->commit();
}
