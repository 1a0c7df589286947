#include "volume/hbByteReader.h"

#include <fmt/format.h>

#include "volume/hbError.h"

std::span<const std::byte> hbByteReader::bytes(std::uint64_t count) {
  if (count > remaining())
    throw hbError(fmt::format("{}: expected {} more bytes at offset {}, found {}", what_, count, offset_, remaining()));
  const auto found = bytes_.subspan(offset_, count);
  offset_ += count;
  return found;
}

void hbByteReader::zeros(std::uint64_t count) {
  const std::uint64_t first = offset_;
  const auto found = bytes(count);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i] != std::byte{0})
      throw hbError(fmt::format("{}: expected a zero byte at offset {}, found {}", what_, first + i,
                                std::to_integer<int>(found[i])));
}

std::string hbByteReader::string(std::size_t cap) {
  const std::uint64_t at = offset_;
  const std::uint32_t length = u32();
  if (length > cap)
    throw hbError(
        fmt::format("{}: expected a text of at most {} bytes at offset {}, found {} bytes", what_, cap, at, length));
  const auto found = bytes(length);
  return {reinterpret_cast<const char*>(found.data()), found.size()};
}

void hbByteReader::finish() const {
  if (remaining() > 0)
    throw hbError(fmt::format("{}: expected the end at offset {}, found {} more bytes", what_, offset_, remaining()));
}
