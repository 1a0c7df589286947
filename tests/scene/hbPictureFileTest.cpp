#include "scene/hbPictureFile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <half.h>
#include <png.h>
#include <rapidcheck/gtest.h>

#include "scene/hbScene.h"
#include "volume/hbError.h"

namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("hbPictureFileTest-" + name);
}

std::string bytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void writeBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Bit for bit, so that NaN equals itself and -0 differs from 0.
bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

hbPicture somePicture(int width, int height) {
  hbPicture picture;
  picture.width = width;
  picture.height = height;
  for (const char* name : {"Y", "A", "Z", "N.X", "N.Y", "N.Z", "value"}) {
    auto& channel = picture.add(name);
    for (std::size_t i = 0; i < channel.size(); ++i) channel[i] = float(name[0]) + float(i % 977) / 7.0F;
  }
  picture.channels["Y"][0] = std::numeric_limits<float>::quiet_NaN();
  picture.channels["Z"][0] = std::numeric_limits<float>::infinity();
  picture.channels["A"][0] = -0.0F;
  picture.metadata[hbPicture::kSceneKey] = hb::toJson(hbScene{});
  picture.metadata["hbvol.a statistic with a name of more than 31 characters"] = "1e-3";
  picture.metadata["hbvol.empty"] = "";
  return picture;
}

template <class F>
std::string errorOf(F&& f) {
  try {
    f();
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

/// A gray, RGB or palette PNG in any form the simplified interface of libpng writes.
template <class T>
void writeForeignPng(const std::filesystem::path& path, int width, int height, unsigned format,
                     const std::vector<T>& samples) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(width);
  png.height = png_uint_32(height);
  png.format = format;
  ASSERT_TRUE(png_image_write_to_file(&png, path.c_str(), 0, samples.data(), 0, nullptr));
}

} // namespace

TEST(hbPictureFile, ExrRoundTripsBitForBit) {
  // One row, one column, and more rows than a strip of the reader or a block of the file has.
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 1}, std::pair{1, 41}, std::pair{33, 700}}) {
    const hbPicture picture = somePicture(width, height);
    const auto path = temporary("round.exr");
    hb::writeExr(picture, path);
    const hbPicture back = hb::readExr(path);
    EXPECT_EQ(back.width, width);
    EXPECT_EQ(back.height, height);
    EXPECT_EQ(back.metadata, picture.metadata);
    ASSERT_EQ(back.channels.size(), picture.channels.size());
    for (const auto& [name, values] : picture.channels) EXPECT_TRUE(sameBits(values, back.channels.at(name))) << name;
  }
}

TEST(hbPictureFile, ExrBytesAreDeterministic) {
  hb::writeExr(somePicture(20, 30), temporary("one.exr"));
  hb::writeExr(somePicture(20, 30), temporary("two.exr"));
  EXPECT_EQ(bytesOf(temporary("one.exr")), bytesOf(temporary("two.exr")));
}

TEST(hbPictureFile, WritingRefusesWhatTheFileCannotHold) {
  const auto refused = [](auto change) {
    hbPicture picture = somePicture(4, 3);
    change(picture);
    const auto path = temporary("refused.exr");
    EXPECT_THROW(hb::writeExr(picture, path), hbError);
    return !std::filesystem::exists(path);
  };
  EXPECT_TRUE(refused([](auto& p) { p.width = 0; }));
  EXPECT_TRUE(refused([](auto& p) { p.height = 16385; }));
  EXPECT_TRUE(refused([](auto& p) { p.channels.clear(); }));
  EXPECT_TRUE(refused([](auto& p) { p.channels["Y"].pop_back(); }));
  EXPECT_TRUE(refused([](auto& p) { p.add(""); }));
  EXPECT_TRUE(refused([](auto& p) { p.add(std::string(256, 'c')); }));
  EXPECT_TRUE(refused([](auto& p) { p.metadata["compression"] = "none"; }));
  EXPECT_THROW(hb::writeExr(somePicture(4, 3), temporary("no-such-folder") / "a.exr"), hbError);
}

TEST(hbPictureFile, ReadsForeignHalfTilesAndDataWindows) {
  // A tiled file of HALF and UINT channels whose data window does not begin at 0.
  const Imath::Box2i window(Imath::V2i(-5, 7), Imath::V2i(-5 + 69, 7 + 299));
  Imf::Header header(window, window);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.setTileDescription(Imf::TileDescription(32, 16));
  header.compression() = Imf::PIZ_COMPRESSION;
  std::vector<half> y(70 * 300);
  std::vector<unsigned> id(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    y[i] = half(float(i % 1000) / 8.0F);
    id[i] = unsigned(i);
  }
  Imf::FrameBuffer source;
  source.insert("Y", Imf::Slice::Make(Imf::HALF, y.data(), window, sizeof(half), sizeof(half) * 70));
  source.insert("id", Imf::Slice::Make(Imf::UINT, id.data(), window, sizeof(unsigned), sizeof(unsigned) * 70));
  const auto path = temporary("foreign.exr");
  {
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(source);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const hbPicture picture = hb::readExr(path);
  ASSERT_EQ(picture.width, 70);
  ASSERT_EQ(picture.height, 300);
  EXPECT_TRUE(picture.metadata.empty());
  for (std::size_t i = 0; i < y.size(); ++i) {
    ASSERT_EQ(picture.channels.at("Y")[i], float(y[i])) << i;
    ASSERT_EQ(picture.channels.at("id")[i], float(i)) << i;
  }
}

TEST(hbPictureFile, RefusesExrFilesBeyondItsLimits) {
  const auto path = temporary("beyond.exr");
  const auto write = [&](const Imath::Box2i& window, int channels, int sampling) {
    Imf::Header header(window, window);
    for (int c = 0; c < channels; ++c)
      header.channels().insert(fmt::format("c{}", c), Imf::Channel(Imf::HALF, sampling, sampling));
    header.compression() = Imf::NO_COMPRESSION;
    const Imf::OutputFile incomplete(path.c_str(), header); // header and table only: the limits come first
  };
  const Imath::Box2i small(Imath::V2i(0), Imath::V2i(7, 7));
  write({Imath::V2i(0), Imath::V2i(16384, 0)}, 1, 1);
  EXPECT_NE(errorOf([&] { hb::readExr(path); }).find("found 16385 x 1"), std::string::npos);
  write(small, 33, 1);
  EXPECT_NE(errorOf([&] { hb::readExr(path); }).find("found 33 channels"), std::string::npos);
  write(small, 1, 2);
  EXPECT_NE(errorOf([&] { hb::readExr(path); }).find("found one for 2 x 2"), std::string::npos);
  write(small, 1, 1);
  EXPECT_NE(errorOf([&] { hb::readExr(path); }).find("damaged OpenEXR picture"), std::string::npos);
}

TEST(hbPictureFile, RefusesOtherData) {
  const auto path = temporary("other.exr");
  for (const std::string& bytes : {std::string(), std::string("v/1"), std::string("\x89PNG\r\n\x1a\n0000000000")}) {
    writeBytes(path, bytes);
    EXPECT_EQ(errorOf([&] { hb::readExr(path); }), path.string() + ": expected an OpenEXR picture, found other data");
  }
  EXPECT_THROW(hb::readExr(temporary("missing.exr")), hbError);
  EXPECT_THROW(hb::readExr(testing::TempDir()), hbError);
  writeBytes(path, std::string("\x76\x2f\x31\x01\x02\x10\x00\x00", 8)); // multi-part
  EXPECT_NE(errorOf([&] { hb::readExr(path); }).find("single-part"), std::string::npos);
}

TEST(hbPictureFile, EveryTruncationOfAnExrIsAnError) {
  hb::writeExr(somePicture(9, 20), temporary("whole.exr"));
  const std::string whole = bytesOf(temporary("whole.exr"));
  const auto path = temporary("cut.exr");
  for (std::size_t length = 0; length < whole.size(); length += length < 900 ? 1 : 37) {
    writeBytes(path, whole.substr(0, length));
    EXPECT_THROW(hb::readExr(path), hbError) << length;
  }
}

TEST(hbPictureFile, AnAttributeThatClaimsMoreThanTheFileIsRefusedUnread) {
  hb::writeExr(somePicture(9, 20), temporary("claim.exr"));
  std::string bytes = bytesOf(temporary("claim.exr"));
  const std::string attribute = std::string("hbvol.empty") + '\0' + "string" + '\0';
  const std::size_t at = bytes.find(attribute);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + attribute.size(), 4, "\xff\xff\xff\x7f"); // 2 GB
  writeBytes(temporary("claim.exr"), bytes);
  EXPECT_NE(errorOf([&] { hb::readExr(temporary("claim.exr")); }).find("damaged OpenEXR header at byte"),
            std::string::npos);
}

RC_GTEST_PROP(hbPictureFile, DamagedPicturesGiveAPictureOrAnError, ()) {
  static const std::vector<std::string> wholes = [] {
    hb::writeExr(somePicture(9, 40), temporary("fuzz.exr"));
    hbImage8 image{9, 40, std::vector<std::uint8_t>(9 * 40 * 3)};
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = std::uint8_t(i * i);
    hb::writePng(image, temporary("fuzz.png"));
    return std::vector{bytesOf(temporary("fuzz.exr")), bytesOf(temporary("fuzz.png"))};
  }();
  const std::size_t kind = *rc::gen::inRange<std::size_t>(0, 2);
  std::string bytes = wholes[kind];
  for (int i = *rc::gen::inRange(1, 4); i > 0; --i)
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
  const auto path = temporary(kind == 0 ? "fuzzed.exr" : "fuzzed.png");
  writeBytes(path, bytes);
  try {
    hb::readPicture(path);
  } catch (const hbError& e) {
    RC_ASSERT(std::string(e.what()).find('\n') == std::string::npos);
  }
}

TEST(hbPictureFile, PngRoundTrips) {
  hbImage8 image{7, 5, std::vector<std::uint8_t>(7 * 5 * 3)};
  for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = std::uint8_t(i * 37);
  hb::writePng(image, temporary("a.png"));
  hb::writePng(image, temporary("b.png"));
  EXPECT_EQ(hb::readPng(temporary("a.png")), image);
  EXPECT_EQ(bytesOf(temporary("a.png")), bytesOf(temporary("b.png")));
}

TEST(hbPictureFile, ReadsEveryKindOfPngAsRgb) {
  const auto path = temporary("kinds.png");
  writeForeignPng<std::uint8_t>(path, 2, 1, PNG_FORMAT_GRAY, {10, 200});
  EXPECT_EQ(hb::readPng(path).rgb, (std::vector<std::uint8_t>{10, 10, 10, 200, 200, 200}));
  writeForeignPng<std::uint8_t>(path, 1, 2, PNG_FORMAT_RGBA, {9, 8, 7, 255, 90, 80, 70, 0});
  EXPECT_EQ(hb::readPng(path).rgb, (std::vector<std::uint8_t>{9, 8, 7, 0, 0, 0}));
}

TEST(hbPictureFile, ReadsSixteenBitPng) {
  // The low-level interface, because the simplified one writes 16 bits as linear light. 0x8080 = 257 * 128.
  const auto path = temporary("sixteen.png");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, 3, 1, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const std::uint8_t row[6] = {0x00, 0x00, 0x80, 0x80, 0xff, 0xff};
  png_write_row(png, row);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
  EXPECT_EQ(hb::readPng(path).rgb, (std::vector<std::uint8_t>{0, 0, 0, 128, 128, 128, 255, 255, 255}));
}

TEST(hbPictureFile, RefusesDamagedAndForeignPng) {
  hbImage8 image{7, 5, std::vector<std::uint8_t>(7 * 5 * 3, 77)};
  const auto path = temporary("damaged.png");
  hb::writePng(image, path);
  const std::string whole = bytesOf(path);
  // The last chunk (IEND, 12 bytes) holds nothing: without it the picture is still whole.
  for (std::size_t length = 0; length + 12 < whole.size(); ++length) {
    writeBytes(path, whole.substr(0, length));
    EXPECT_THROW(hb::readPng(path), hbError) << length;
  }
  EXPECT_THROW(hb::readPng(temporary("missing.png")), hbError);
  image.rgb.pop_back();
  EXPECT_THROW(hb::writePng(image, path), hbError);
  EXPECT_THROW(hb::writePng(hbImage8{}, path), hbError);
  writeForeignPng(path, 16385, 1, PNG_FORMAT_GRAY, std::vector<std::uint8_t>(16385));
  EXPECT_NE(errorOf([&] { hb::readPng(path); }).find("found 16385 x 1"), std::string::npos);
}

TEST(hbPictureFile, TheExtensionChoosesTheReader) {
  hb::writeExr(somePicture(3, 2), temporary("a.exr"));
  hb::writePng({1, 1, {1, 2, 3}}, temporary("a.PNG"));
  EXPECT_EQ(std::get<hbPicture>(hb::readPicture(temporary("a.exr"))).width, 3);
  EXPECT_EQ(std::get<hbImage8>(hb::readPicture(temporary("a.PNG"))).rgb[2], 3);
  EXPECT_EQ(errorOf([] { hb::readPicture("folder/a.jpg"); }), "folder/a.jpg: expected a picture named .exr or .png");
}
