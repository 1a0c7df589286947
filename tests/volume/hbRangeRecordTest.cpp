#include "volume/hbRangeRecord.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST(hbRangeRecord, ComesBackWhole) {
  const hbRangeRecord record{{{-1.0, 2.5}, {0.0, 0.0}, {-kInf, kInf}}};
  EXPECT_EQ(hbRangeRecord::decode(record.encode(), "x"), record);
  EXPECT_EQ(record.encode().size(), 8U + 3 * 16);
  const auto empty = hbRangeRecord::decode(hbRangeRecord{{{kNan, kNan}}}.encode(), "x");
  EXPECT_TRUE(std::isnan(empty.components[0].lo) && std::isnan(empty.components[0].hi));
}

TEST(hbRangeRecord, RefusesWhatIsNoRecord) {
  const auto with = [](std::size_t at, auto value) {
    auto bytes = hbRangeRecord{{{0.0, 1.0}}}.encode();
    hb::test::poke(bytes, at, value);
    return bytes;
  };
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(8, 2.0), "x"), "x: component 0: expected a least value not above");
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(8, kNan), "x"), "x: component 0: expected a least value not above");
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(16, kNan), "x"), "x: component 0: expected a least value not above");
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(0, std::uint32_t{0}), "x"), "x: expected the end at offset 8");
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(0, ~std::uint32_t{0}), "x"), "x: expected 8 more bytes at offset 24");
  EXPECT_HB_ERROR(hbRangeRecord::decode(with(7, std::uint8_t{1}), "x"), "x: expected a zero byte at offset 7");
  EXPECT_HB_ERROR((hbRangeRecord{{{1.0, 0.0}}}.encode()), "range record: component 0: expected a least value");
}
