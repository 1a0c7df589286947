#include "volume/hbRawFile.h"

#include <sys/resource.h>
#include <unistd.h>

#include "tests/volume/testFiles.h"

TEST(hbRawFile, ReadsTheLayoutFromTheName) {
  const auto layout = hb::rawLayoutFromName("/data/my_head_256x128x64_uint16.raw");
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->size, hbSize3(256, 128, 64));
  EXPECT_EQ(layout->type, hbSampleType::uint16);
  for (const std::string type : {"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"}) {
    const auto each = hb::rawLayoutFromName("a_1x2x3_" + type + ".raw");
    ASSERT_TRUE(each) << type;
    EXPECT_EQ(hb::sampleTypeName(each->type), type);
    EXPECT_EQ(hb::rawFileName("a", each->size, each->type), "a_1x2x3_" + type + ".raw");
  }
  for (const char* none :
       {"a.raw", "a_1x2_uint8.raw", "a_1x2x3x4_uint8.raw", "a_1x2x3_uint64.raw", "a_1x2x3_uint8.dat", "1x2x3_uint8.raw",
        "a_1x2x_uint8.raw", "a_1x-2x3_uint8.raw", "a_1x2x3_uint8_b.raw", "_uint8.raw"})
    EXPECT_FALSE(hb::rawLayoutFromName(none)) << none;
  EXPECT_ERROR(hb::rawLayoutFromName("a_99999999999999999999x2x3_uint8.raw"), "2^63");
}

TEST(hbRawFile, MapsEveryOrderOfAxesAndBytes) {
  // Sample (x,y,z), component c holds x + 10 y + 100 z + 1000 c; the file is written in the order under test.
  const hbSize3 size(3, 2, 4);
  const auto dir = test::folder();
  int number = 0;
  for (const std::string order : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"})
    for (const bool planar : {false, true})
      for (const bool bigEndian : {false, true}) {
        hbRawLayout layout;
        layout.size = size;
        layout.type = hbSampleType::int16;
        layout.bigEndian = bigEndian;
        layout.axisOrder = order;
        layout.offset = 5; // leaves the samples unaligned
        layout.components = 2;
        layout.interleaving = planar ? hbRawLayout::Interleaving::planar : hbRawLayout::Interleaving::packed;
        layout.spacing = {1.0, 2.0, 3.0};
        std::vector<std::int16_t> samples;
        const auto loop = [&](auto each) {
          hbSize3 at;
          const int a = order[0] - 'x', b = order[1] - 'x', c = order[2] - 'x';
          for (at[c] = 0; at[c] < size[c]; ++at[c])
            for (at[b] = 0; at[b] < size[b]; ++at[b])
              for (at[a] = 0; at[a] < size[a]; ++at[a]) each(at);
        };
        const auto value = [](const hbSize3& at, int c) {
          return std::int16_t(at.x + 10 * at.y + 100 * at.z + 1000 * c);
        };
        if (planar)
          for (int c = 0; c < 2; ++c) loop([&](const hbSize3& at) { samples.push_back(value(at, c)); });
        else
          loop([&](const hbSize3& at) {
            for (int c = 0; c < 2; ++c) samples.push_back(value(at, c));
          });
        const auto path = test::write(dir / std::to_string(number++), "12345" + test::bytes(samples, bigEndian));
        const hbVolume volume = hb::openRawFile(path, layout);
        EXPECT_EQ(volume.geometry().spacing, layout.spacing);
        EXPECT_EQ(volume.geometry().size, size);
        loop([&](const hbSize3& at) {
          for (int c = 0; c < 2; ++c)
            ASSERT_EQ(volume.value(at.x, at.y, at.z, c), value(at, c)) << order << planar << bigEndian;
        });
      }
}

TEST(hbRawFile, RefusesWhatDoesNotFit) {
  const auto dir = test::folder();
  const auto path = test::write(dir / "a.raw", std::string(24, 'a'));
  hbRawLayout layout;
  layout.size = {2, 3, 4};
  EXPECT_NO_THROW(hb::openRawFile(path, layout));
  const auto with = [&](auto change) {
    hbRawLayout other = layout;
    change(other);
    return hb::openRawFile(path, other);
  };
  EXPECT_ERROR(with([](auto& l) { l.size.z = 5; }), "expected 30 bytes (0 + 2 x 3 x 5 samples of 1 uint8), found 24");
  EXPECT_ERROR(with([](auto& l) { l.size.z = 3; }), "expected 18 bytes");
  EXPECT_ERROR(with([](auto& l) { l.offset = 1; }), "expected 25 bytes (1 + ");
  EXPECT_ERROR(with([](auto& l) { l.size.y = 0; }), "at least one node along y");
  EXPECT_ERROR(with([](auto& l) { l.size.y = std::int64_t{1} << 60; }), "2^60");
  EXPECT_ERROR(with([](auto& l) { l.components = 0; }), "at least one component");
  EXPECT_ERROR(with([](auto& l) { l.axisOrder = "xyy"; }), "xyy");
  EXPECT_ERROR(with([](auto& l) { l.axisOrder = ""; }), "axis order");
  EXPECT_ERROR(with([](auto& l) { l.spacing.x = -1.0; }), "spacing");
  EXPECT_ERROR(with([](auto& l) {
                 l.size = {1 << 19, 1 << 20, 1 << 20};
                 l.type = hbSampleType::float64;
                 l.components = 1 << 10;
               }),
               "2^63");
  EXPECT_ERROR(hb::openRawFile(dir / "missing.raw", layout), "missing.raw");
}

TEST(hbRawFile, OpensAFileLargerThanTheMemory) {
  // 40 GB of holes: reading its end touches one page.
  const auto dir = test::folder();
  const auto path = dir / "huge_2048x2048x5120_uint16.raw";
  const auto layout = hb::rawLayoutFromName(path);
  ASSERT_TRUE(layout);
  const std::uintmax_t bytes = std::uintmax_t{2048} * 2048 * 5120 * 2;
  test::write(path, "");
  std::filesystem::resize_file(path, bytes);
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(std::streamoff(bytes - 2)).write("\x34\x12", 2);
  }
  struct rusage before {
  }, after{};
  ::getrusage(RUSAGE_SELF, &before);
  const hbVolume volume = hb::openRawFile(path, *layout);
  EXPECT_EQ(volume.value(2047, 2047, 5119), 0x1234);
  EXPECT_EQ(volume.value(0, 0, 0), 0.0);
  ::getrusage(RUSAGE_SELF, &after);
  // ru_maxrss counts kB; 16 MB allow for what the rest of the process does.
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 16 * 1024);
  std::filesystem::remove(path);
}
