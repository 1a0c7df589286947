#include "volume/hbDatasetInfo.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();

hbDatasetInfo example() {
  hbDatasetInfo info;
  info.geometry.size = {512, 1, 33};
  info.geometry.origin = {-1.5, 0.0, 1e9};
  info.geometry.spacing = {0.1, 2.0, 3.0};
  info.geometry.direction = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
  info.geometry.centring = hbGeometry::Centring::cell;
  info.geometry.space = "left-posterior-superior";
  info.sampleType = hbSampleType::uint16;
  info.slope = -0.25;
  info.intercept = 1024.0;
  info.valueMap = {1e6, 0x1p40};
  info.mapping = hbLatticeMapping::aligned;
  info.componentNames = {"density", "", std::string(255, 'x')};
  return info;
}

} // namespace

TEST(hbDatasetInfo, ComesBackWhole) {
  EXPECT_EQ(hbDatasetInfo::decode(example().encode(), "x"), example());
  EXPECT_EQ(hbDatasetInfo::decode(hbDatasetInfo().encode(), "x"), hbDatasetInfo());
}

TEST(hbDatasetInfo, HasTheDocumentedLayout) {
  const auto bytes = example().encode();
  EXPECT_EQ(bytes.size(), 184U + (4 + 23) + (4 + 7) + 4 + (4 + 255));
  const auto number = [&](std::size_t at, auto tag) {
    std::memcpy(&tag, bytes.data() + at, sizeof(tag));
    return tag;
  };
  EXPECT_EQ(number(16, std::int64_t{}), 33);
  EXPECT_EQ(number(40, double{}), 1e9);
  EXPECT_EQ(number(48, double{}), 0.1);
  EXPECT_EQ(number(80, double{}), 1.0);  // the first axis points along +y
  EXPECT_EQ(number(96, double{}), -1.0); // the second along -x
  EXPECT_EQ(number(144, double{}), -0.25);
  EXPECT_EQ(number(152, double{}), 1024.0);
  EXPECT_EQ(number(160, double{}), 1e6);
  EXPECT_EQ(number(168, double{}), 0x1p40);
  EXPECT_EQ(number(176, std::uint32_t{}), 0x00010401U); // cell, uint16, aligned, reserved
  EXPECT_EQ(number(180, std::uint32_t{}), 3U);
}

TEST(hbDatasetInfo, RefusesEveryLengthButItsOwn) {
  auto bytes = example().encode();
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_THROW(hbDatasetInfo::decode(std::span(bytes).first(size), "x"), hbError) << size;
  bytes.push_back(std::byte{0});
  EXPECT_HB_ERROR(hbDatasetInfo::decode(bytes, "file: GEOM"), "file: GEOM: expected the end at offset");
}

TEST(hbDatasetInfo, ChecksEveryField) {
  const auto with = [](std::size_t at, auto value) {
    auto bytes = hbDatasetInfo().encode(); // an empty space name at 184, one empty component name at 188
    hb::test::poke(bytes, at, value);
    return bytes;
  };
#define EXPECT_REFUSED(at, value, text) EXPECT_HB_ERROR(hbDatasetInfo::decode(with(at, value), "x"), text)
  for (const std::size_t axis : {0U, 1U, 2U}) {
    EXPECT_REFUSED(8 * axis, std::int64_t{0}, "x: expected at least one node");
    EXPECT_REFUSED(8 * axis, std::int64_t{-1}, "x: expected at least one node");
    EXPECT_REFUSED(8 * axis, std::int64_t{1} << 60, "x: expected fewer than 2^60 samples");
    EXPECT_REFUSED(24 + 8 * axis, kNan, "x: expected a finite origin");
    EXPECT_REFUSED(48 + 8 * axis, 0.0, "x: expected a positive spacing");
    EXPECT_REFUSED(48 + 8 * axis, kInf, "x: expected a positive spacing");
  }
  for (std::size_t at = 72; at < 144; at += 8) EXPECT_REFUSED(at, kNan, "x: expected a unit direction");
  EXPECT_REFUSED(144, 0.0, "x: expected a finite slope other than 0");
  EXPECT_REFUSED(144, kInf, "x: expected a finite slope other than 0");
  EXPECT_REFUSED(152, kNan, "a finite intercept");
  EXPECT_REFUSED(160, kInf, "x: expected a finite offset");
  EXPECT_REFUSED(168, 0.0, "a positive, finite scale");
  EXPECT_REFUSED(168, -1.0, "a positive, finite scale");
  EXPECT_REFUSED(168, kNan, "a positive, finite scale");
  EXPECT_REFUSED(176, std::uint8_t{2}, "x: expected centring 0 or 1, found 2");
  EXPECT_REFUSED(177, std::uint8_t{0}, "x: expected a sample type from 1 to 8, found 0");
  EXPECT_REFUSED(177, std::uint8_t{9}, "x: expected a sample type from 1 to 8, found 9");
  EXPECT_REFUSED(178, std::uint8_t{2}, "x: expected lattice mapping 0 or 1, found 2");
  EXPECT_REFUSED(179, std::uint8_t{1}, "x: expected a zero byte at offset 179, found 1");
  EXPECT_REFUSED(180, std::uint32_t{0}, "x: expected the end at offset 188");
  EXPECT_REFUSED(180, std::numeric_limits<std::uint32_t>::max(), "x: expected 4 more bytes at offset 192, found 0");
  EXPECT_REFUSED(184, std::uint32_t{256}, "x: expected a text of at most 255 bytes at offset 184, found 256");
  EXPECT_REFUSED(188, std::uint32_t{256}, "x: expected a text of at most 255 bytes at offset 188, found 256");
#undef EXPECT_REFUSED
}

TEST(hbDatasetInfo, DoesNotWriteWhatItWouldNotRead) {
  hbDatasetInfo info;
  info.componentNames = {std::string(256, 'x')};
  EXPECT_HB_ERROR(info.encode(), "dataset: expected component names of at most 255 bytes, found 256");
  info.componentNames.clear();
  EXPECT_HB_ERROR(info.encode(), "dataset: expected 1 to 65535 components, found 0");
  info.componentNames.resize(65536);
  EXPECT_HB_ERROR(info.encode(), "dataset: expected 1 to 65535 components, found 65536");
  hbDatasetInfo longSpace;
  longSpace.geometry.space.resize(256);
  EXPECT_HB_ERROR(longSpace.encode(), "dataset: expected a name of the space of at most 255 bytes, found 256");
}
