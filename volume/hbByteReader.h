#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

/// Reads little-endian numbers, texts and arrays from bytes that may be damaged: no read passes the end, and nothing is
/// allocated before its size was compared with the bytes left.
///
/// A read beyond the end throws hbError "<what>: expected N more bytes at offset O, found M". The bytes are not copied
/// and must outlive the reader.
class hbByteReader {
public:
  static_assert(std::endian::native == std::endian::little, "files are little-endian and so must be the machine");

  /// `what` names the file and the place in error messages.
  hbByteReader(std::span<const std::byte> bytes, std::string what) : bytes_(bytes), what_(std::move(what)) {}

  std::uint8_t u8() { return get<std::uint8_t>(); }
  std::uint16_t u16() { return get<std::uint16_t>(); }
  std::uint32_t u32() { return get<std::uint32_t>(); }
  std::uint64_t u64() { return get<std::uint64_t>(); }
  std::int64_t i64() { return get<std::int64_t>(); }
  float f32() { return get<float>(); }
  double f64() { return get<double>(); }

  /// `count` bytes that must be zero (reserved fields, padding); throws hbError at the first one that is not.
  void zeros(std::uint64_t count);

  /// A u32 with the length, then as many bytes. Throws hbError where the length is above `cap`.
  std::string string(std::size_t cap);

  std::vector<float> floats(std::uint64_t count) { return array<float>(count); }
  std::vector<double> doubles(std::uint64_t count) { return array<double>(count); }

  /// A view of the next `count` bytes.
  std::span<const std::byte> bytes(std::uint64_t count);

  std::uint64_t offset() const { return offset_; }
  std::uint64_t remaining() const { return bytes_.size() - offset_; }
  const std::string& what() const { return what_; }

  /// Throws hbError when bytes are left over.
  void finish() const;

private:
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, bytes(sizeof(T)).data(), sizeof(T));
    return value;
  }

  template <class T>
  std::vector<T> array(std::uint64_t count) {
    // An absurd count saturates rather than overflows: no span holds 2^64 - 1 bytes.
    const std::uint64_t size = count > UINT64_MAX / sizeof(T) ? UINT64_MAX : count * sizeof(T);
    const std::span<const std::byte> from = bytes(size);
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), from.data(), from.size());
    return values;
  }

  std::span<const std::byte> bytes_;
  std::string what_;
  std::size_t offset_ = 0;
};
