#include "volume/coding/hbByteCodec.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// Unpacks `packed`, handed out in pieces of `piece` bytes.
std::vector<std::byte> decode(hbCodec codec, std::span<const std::byte> packed, std::uint64_t rawSize,
                              std::uint64_t limit = kNoLimit, std::size_t piece = 4096,
                              std::uint16_t version = hb::kCodecVersion) {
  const auto source = [&] {
    const auto next = packed.first(std::min(piece, packed.size()));
    packed = packed.subspan(next.size());
    return next;
  };
  return hb::decodeBytes(codec, version, source, rawSize, limit, "x");
}

std::vector<std::byte> bytesFrom(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(std::byte(value));
  return bytes;
}

/// Floats as surpluses are: signs and mantissas without a pattern, exponents with one.
std::vector<std::byte> roughFloats(std::size_t count) {
  std::vector<float> values(count);
  std::uint32_t state = 1;
  for (float& value : values) {
    state = state * 1664525U + 1013904223U;
    value = float(std::int32_t(state)) * 0x1p-40F;
  }
  const auto view = std::as_bytes(std::span(values));
  return {view.begin(), view.end()};
}

} // namespace

RC_GTEST_PROP(hbByteCodec, UnpacksWhatItPacked, ()) {
  const auto codec = *rc::gen::element(hbCodec::zstd, hbCodec::planesZstd);
  // Repeated, so that most are worth packing; of any length modulo 4.
  const auto pattern = *rc::gen::nonEmpty<std::vector<std::uint8_t>>();
  const auto size = std::size_t(*rc::gen::inRange(0, 5000));
  std::vector<std::byte> raw(size);
  for (std::size_t i = 0; i < size; ++i) raw[i] = std::byte(pattern[i % pattern.size()]);
  const auto packed = hb::encodeBytes(codec, raw);
  RC_CLASSIFY(packed.has_value());
  if (!packed) return;
  RC_ASSERT(packed->size() < raw.size());
  RC_ASSERT(decode(codec, *packed, size, size, std::size_t(*rc::gen::inRange(1, 300))) == raw);
}

TEST(hbByteCodec, BlocksBeyondTheDecodingStepComeBack) {
  // Two whole blocks of 512 KiB and a part of one, with bytes left over behind the last element.
  std::vector<std::byte> raw = roughFloats((std::size_t{512} << 10U) / 4 * 2 + 1000);
  raw.insert(raw.end(), {std::byte{7}, std::byte{8}, std::byte{9}});
  const auto packed = hb::encodeBytes(hbCodec::planesZstd, raw);
  ASSERT_TRUE(packed);
  EXPECT_EQ(decode(hbCodec::planesZstd, *packed, raw.size(), raw.size(), 1000003), raw);
  // Exactly one block, and one element more.
  for (const std::size_t size : {std::size_t{512} << 10U, (std::size_t{512} << 10U) + 4}) {
    const auto part = hb::encodeBytes(hbCodec::planesZstd, std::span(raw).first(size));
    ASSERT_TRUE(part);
    EXPECT_EQ(decode(hbCodec::planesZstd, *part, size),
              std::vector<std::byte>(raw.begin(), raw.begin() + std::ptrdiff_t(size)));
  }
}

TEST(hbByteCodec, PlanesSeparateExponentsFromMantissas) {
  // What planesZstd is for: the exponent bytes of such floats carry about two bits of eight, the three others eight.
  const auto raw = roughFloats(100000);
  const auto plain = hb::encodeBytes(hbCodec::zstd, raw), planes = hb::encodeBytes(hbCodec::planesZstd, raw);
  ASSERT_TRUE(planes);
  EXPECT_LT(planes->size(), raw.size() * 9 / 10);
  EXPECT_LT(planes->size(), plain ? plain->size() : raw.size());
}

TEST(hbByteCodec, WhatDoesNotShrinkIsNotPacked) {
  EXPECT_FALSE(hb::encodeBytes(hbCodec::stored, std::vector<std::byte>(1000)));
  EXPECT_FALSE(hb::encodeBytes(hbCodec::zstd, {}));
  EXPECT_FALSE(hb::encodeBytes(hbCodec::zstd, std::vector<std::byte>(1)));
  EXPECT_FALSE(hb::encodeBytes(hbCodec::planesZstd, std::vector<std::byte>(8)));
  auto noise = roughFloats(1000);
  std::uint32_t state = 7;
  for (std::byte& b : noise) b = std::byte((state = state * 1664525U + 1013904223U) >> 24U);
  EXPECT_FALSE(hb::encodeBytes(hbCodec::zstd, noise));
  EXPECT_FALSE(hb::encodeBytes(hbCodec::planesZstd, noise));
}

TEST(hbByteCodec, TheLayoutOfPlanesIsTheDocumentedOne) {
  // A zstd frame by hand (RFC 8878): magic, no content size, window 2^20, one raw block that is the last. Its nine
  // bytes are the planes of two elements, and one byte left over.
  const auto frame =
      bytesFrom({0x28, 0xB5, 0x2F, 0xFD, 0x00, 0x50, 9 << 3 | 1, 0, 0, 10, 20, 11, 21, 12, 22, 13, 23, 99});
  EXPECT_EQ(decode(hbCodec::planesZstd, frame, 9), bytesFrom({10, 11, 12, 13, 20, 21, 22, 23, 99}));
  EXPECT_EQ(decode(hbCodec::zstd, frame, 9), bytesFrom({10, 20, 11, 21, 12, 22, 13, 23, 99}));
}

TEST(hbByteCodec, FramesWithBlocksAcrossTheDecodingStepComeBack) {
  // Six blocks of 100000 equal bytes: the last one crosses the step of 512 KiB, so that zstd still holds a part of it
  // when all the packed bytes were taken.
  auto frame = bytesFrom({0x28, 0xB5, 0x2F, 0xFD, 0x00, 0x50});
  std::vector<std::byte> raw;
  for (int block = 0; block < 6; ++block) {
    const unsigned header = 100000U << 3U | 1U << 1U | (block == 5 ? 1U : 0U);
    for (const unsigned shift : {0U, 8U, 16U}) frame.push_back(std::byte(header >> shift));
    frame.push_back(std::byte(block));
    raw.insert(raw.end(), 100000, std::byte(block));
  }
  EXPECT_EQ(decode(hbCodec::zstd, frame, raw.size()), raw);
  EXPECT_HB_ERROR(decode(hbCodec::zstd, frame, raw.size() - 1), "bytes when unpacked, found more");
}

TEST(hbByteCodec, RefusesWindowsThatWouldTakeMuchMemory) {
  auto frame = bytesFrom({0x28, 0xB5, 0x2F, 0xFD, 0x00, 13 << 3, 1 << 3 | 1, 0, 0, 42}); // window 2^23
  EXPECT_EQ(decode(hbCodec::zstd, frame, 1), bytesFrom({42}));
  frame[5] = std::byte{14 << 3}; // window 2^24
  EXPECT_HB_ERROR(decode(hbCodec::zstd, frame, 1), "x: expected a zstd frame with a window of at most 8 MiB, found");
}

TEST(hbByteCodec, RefusesStreamsThatLieAboutTheirSize) {
  for (const hbCodec codec : {hbCodec::zstd, hbCodec::planesZstd}) {
    const std::vector<std::byte> zeros(std::size_t{16} << 20U);
    const auto packed = hb::encodeBytes(codec, zeros);
    ASSERT_TRUE(packed);
    // A bomb: a few kB that unpack to 16 MiB. The step before the refusal is all that is unpacked.
    for (const std::uint64_t claimed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{3000}, zeros.size() - 1})
      EXPECT_HB_ERROR(decode(codec, *packed, claimed), "bytes when unpacked, found more");
    EXPECT_HB_ERROR(decode(codec, *packed, zeros.size() + 1), "expected 16777217 bytes when unpacked, found 16777216");
    EXPECT_HB_ERROR(decode(codec, *packed, zeros.size(), zeros.size() - 1),
                    "x: expected at most 16777215 bytes of memory to be needed, found 16777216");
    EXPECT_HB_ERROR(decode(codec, *packed, std::uint64_t{1} << 60U, std::uint64_t{1} << 30U), "of memory");
  }
  const std::vector<std::byte> plain(10);
  EXPECT_EQ(decode(hbCodec::stored, plain, 10, 10, 3), plain);
  EXPECT_HB_ERROR(decode(hbCodec::stored, plain, 9), "expected 9 bytes when unpacked, found more");
  EXPECT_HB_ERROR(decode(hbCodec::stored, plain, 11), "expected 11 bytes when unpacked, found 10");
}

TEST(hbByteCodec, RefusesDamagedStreams) {
  const std::vector<std::byte> raw(1000);
  auto packed = *hb::encodeBytes(hbCodec::zstd, raw);
  for (std::size_t size = 0; size < packed.size(); ++size)
    EXPECT_HB_ERROR(decode(hbCodec::zstd, std::span(packed).first(size), raw.size()), "expected a whole zstd frame");
  auto twice = packed;
  twice.insert(twice.end(), packed.begin(), packed.end());
  for (const std::size_t piece : {std::size_t{1}, packed.size(), twice.size()})
    EXPECT_HB_ERROR(decode(hbCodec::zstd, twice, raw.size(), kNoLimit, piece), "after the end of the zstd frame");
  packed[0] ^= std::byte{1};
  EXPECT_HB_ERROR(decode(hbCodec::zstd, packed, raw.size()), "x: expected a zstd frame");
}

TEST(hbByteCodec, RefusesUnknownCodecsAndVersions) {
  EXPECT_HB_ERROR(decode(hbCodec(7), {}, 0),
                  "x: expected a codec from 0 to 2 in version 1, found codec 7 in version 1");
  EXPECT_HB_ERROR(decode(hbCodec::zstd, {}, 0, kNoLimit, 1, 2), "found codec 1 in version 2");
  EXPECT_FALSE(hb::canDecode(hbCodec(3), hb::kCodecVersion));
  EXPECT_TRUE(hb::canDecode(hbCodec::planesZstd, hb::kCodecVersion));
}
