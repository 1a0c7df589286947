#include "volume/hbByteReader.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbByteWriter.h"

TEST(hbByteReader, ReadsWhatTheWriterWrote) {
  constexpr std::array<float, 3> kFloats{1.5F, -0.0F, std::numeric_limits<float>::infinity()};
  constexpr std::array<double, 2> kDoubles{1e300, std::numeric_limits<double>::denorm_min()};
  hbByteWriter out;
  out.u8(0xFE);
  out.u16(0xFEDC);
  out.u32(0xFEDCBA98U);
  out.u64(0xFEDCBA9876543210U);
  out.i64(std::numeric_limits<std::int64_t>::min());
  out.f32(-1.25F);
  out.f64(0.1);
  out.zeros(3);
  out.string("näme");
  out.string("");
  out.floats(kFloats);
  out.doubles(kDoubles);
  const auto bytes = out.take();
  EXPECT_EQ(out.size(), 0U);
  EXPECT_EQ(bytes.size(), 1U + 2 + 4 + 8 + 8 + 4 + 8 + 3 + (4 + 5) + 4 + 12 + 16);

  hbByteReader in(bytes, "x");
  EXPECT_EQ(in.u8(), 0xFE);
  EXPECT_EQ(in.u16(), 0xFEDC);
  EXPECT_EQ(in.u32(), 0xFEDCBA98U);
  EXPECT_EQ(in.u64(), 0xFEDCBA9876543210U);
  EXPECT_EQ(in.i64(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(in.f32(), -1.25F);
  EXPECT_EQ(in.f64(), 0.1);
  in.zeros(3);
  EXPECT_EQ(in.string(5), "näme");
  EXPECT_EQ(in.string(0), "");
  EXPECT_EQ(in.floats(3), std::vector<float>(kFloats.begin(), kFloats.end()));
  EXPECT_EQ(in.remaining(), 16U);
  EXPECT_EQ(in.doubles(2), std::vector<double>(kDoubles.begin(), kDoubles.end()));
  EXPECT_NO_THROW(in.finish());
  EXPECT_EQ(in.floats(0), std::vector<float>());
}

TEST(hbByteReader, NumbersAreLittleEndian) {
  hbByteWriter out;
  out.u32(0x01020304U);
  EXPECT_EQ(out.take(), (std::vector<std::byte>{std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}}));
}

TEST(hbByteReader, StopsAtTheEnd) {
  const std::vector<std::byte> bytes(6);
  hbByteReader in(bytes, "file: place");
  in.u32();
  EXPECT_HB_ERROR(in.u64(), "file: place: expected 8 more bytes at offset 4, found 2");
  EXPECT_HB_ERROR(in.finish(), "file: place: expected the end at offset 4, found 2 more bytes");
  EXPECT_EQ(in.u16(), 0); // a failed read takes nothing
}

TEST(hbByteReader, ComparesCountsWithTheBytesLeftBeforeAllocating) {
  const std::vector<std::byte> bytes(16);
  hbByteReader in(bytes, "x");
  EXPECT_HB_ERROR(in.floats(5), "expected 20 more bytes at offset 0, found 16");
  // 2^62 floats are 2^64 bytes, which wrap around to 0.
  EXPECT_HB_ERROR(in.floats(std::uint64_t{1} << 62U), "more bytes at offset 0, found 16");
  EXPECT_HB_ERROR(in.doubles((std::uint64_t{1} << 61U) + 1), "more bytes at offset 0, found 16");
  EXPECT_HB_ERROR(in.bytes(std::numeric_limits<std::uint64_t>::max()), "found 16");
  EXPECT_EQ(in.doubles(2).size(), 2U);
}

TEST(hbByteReader, RefusesLongTextsAndReservedBytesThatAreSet) {
  hbByteWriter out;
  out.string("four");
  out.u16(0x0100);
  const auto bytes = out.take();
  EXPECT_HB_ERROR(hbByteReader(bytes, "x").string(3), "x: expected a text of at most 3 bytes at offset 0, found 4");
  hbByteReader in(bytes, "x");
  in.string(4);
  EXPECT_HB_ERROR(in.zeros(2), "x: expected a zero byte at offset 9, found 1");
  // A length beyond the end, within the cap.
  EXPECT_HB_ERROR(hbByteReader(std::span(bytes).first(6), "x").string(255),
                  "expected 4 more bytes at offset 4, found 2");
}
