#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

/// Collects little-endian numbers, texts and arrays, without padding, into one array of bytes.
///
/// The counterpart of hbByteReader. Amortised O(1) a byte.
class hbByteWriter {
public:
  static_assert(std::endian::native == std::endian::little, "files are little-endian and so must be the machine");

  void u8(std::uint8_t value) { put(value); }
  void u16(std::uint16_t value) { put(value); }
  void u32(std::uint32_t value) { put(value); }
  void u64(std::uint64_t value) { put(value); }
  void i64(std::int64_t value) { put(value); }
  void f32(float value) { put(value); }
  void f64(double value) { put(value); }

  /// `count` zero bytes: reserved fields and padding.
  void zeros(std::size_t count);

  /// A u32 with the length in bytes, then the bytes; no terminating zero. Below 2^32 bytes.
  void string(std::string_view text) {
    u32(std::uint32_t(text.size()));
    bytes(std::as_bytes(std::span(text)));
  }

  void floats(std::span<const float> values) { bytes(std::as_bytes(values)); }
  void doubles(std::span<const double> values) { bytes(std::as_bytes(values)); }
  void bytes(std::span<const std::byte> values);

  std::size_t size() const { return bytes_.size(); }

  /// What was written so far; the writer is empty afterwards.
  std::vector<std::byte> take() { return std::exchange(bytes_, {}); }

private:
  template <class T>
  void put(T value) {
    bytes(std::as_bytes(std::span(&value, 1)));
  }

  std::vector<std::byte> bytes_;
};
