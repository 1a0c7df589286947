#include "volume/hbErrorRecord.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
using Reference = hbErrorRecord::Reference;
using Kind = hbErrorRecord::Kind;

hbErrorRecord example() {
  return {{{Reference::allSamples, Kind::measured, std::uint64_t{1} << 40U, 0.5, 0.125, 60.25},
           {Reference::randomSamples, Kind::guaranteed, 1000, 0.0, 0.0, kInf},
           {Reference::analyticField, Kind::measured, 7, 1e300, 1e-300, -3.0}}};
}

} // namespace

TEST(hbErrorRecord, ComesBackWhole) {
  EXPECT_EQ(hbErrorRecord::decode(example().encode(), "x"), example());
  EXPECT_EQ(hbErrorRecord::decode(hbErrorRecord().encode(), "x"), hbErrorRecord());
  EXPECT_EQ(example().encode().size(), 8U + 3 * 40);
  // NaN, which no comparison finds equal: not known.
  const auto unknown = hbErrorRecord::decode(
      hbErrorRecord{{{Reference::allSamples, Kind::guaranteed, 1, 0.5, kNan, kNan}}}.encode(), "x");
  EXPECT_EQ(unknown.components[0].max, 0.5);
  EXPECT_TRUE(std::isnan(unknown.components[0].rmse) && std::isnan(unknown.components[0].psnr));
}

TEST(hbErrorRecord, RefusesWhatIsNoRecord) {
  const auto with = [](std::size_t at, auto value) {
    auto bytes = example().encode();
    hb::test::poke(bytes, at, value);
    return bytes;
  };
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(0, std::uint32_t{2}), "x"), "x: expected the end at offset 88");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(0, ~std::uint32_t{0}), "x"), "x: expected 1 more bytes at offset 128");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(4, std::uint8_t{1}), "x"), "x: expected a zero byte at offset 4");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(48, std::uint8_t{3}), "x"), "component 1: expected reference 0, 1 or 2");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(49, std::uint8_t{2}), "x"), "component 1: expected kind 0 or 1, found 2");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(55, std::uint8_t{1}), "x"), "x: expected a zero byte at offset 55");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(24, -1.0), "x"), "component 0: expected errors of at least 0");
  EXPECT_HB_ERROR(hbErrorRecord::decode(with(32, -kInf), "x"), "component 0: expected errors of at least 0");
  const auto bytes = example().encode();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_THROW(hbErrorRecord::decode(std::span(bytes).first(size), "x"), hbError) << size;

  hbErrorRecord negative = example();
  negative.components[0].max = -1.0;
  EXPECT_HB_ERROR(negative.encode(), "error record: component 0: expected errors of at least 0");
}
