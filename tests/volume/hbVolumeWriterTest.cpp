#include "volume/hbVolumeWriter.h"

#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/resource.h>

#include "tests/volume/testFiles.h"
#include "volume/hbRawFile.h"
#include "volume/hbVolumeReader.h"
#include "volume/hbVolumeStream.h"

namespace fs = std::filesystem;

namespace {

/// An oblique, anisotropic grid.
hbGeometry oblique(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  g.origin = {1.25, -7.0, 1e-3};
  g.spacing = {0.1, 2.0, 3.5};
  g.direction = glm::dmat3(glm::dvec3(0.6, 0.8, 0.0), glm::dvec3(0.8, -0.6, 0.0), glm::dvec3(0.0, 0.0, 1.0));
  g.space = "left-posterior-superior";
  return g;
}

/// The text between `before` and the next quote.
std::string attribute(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(" " + name + "=\"");
  if (at == std::string::npos) return "missing";
  const std::size_t first = at + name.size() + 3;
  return text.substr(first, text.find('"', first) - first);
}

/// Checks that tags nest and close; returns how many there were.
int checkNesting(const std::string& xml) {
  std::vector<std::string> open;
  int tags = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    EXPECT_NE(end, std::string::npos);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" /?>", 1) - (tag[0] == '/' ? 1 : 0));
    if (tag[0] == '?') continue;
    ++tags;
    if (tag[0] == '/') {
      if (open.empty()) {
        ADD_FAILURE() << tag;
        return tags;
      }
      EXPECT_EQ(open.back(), tag.substr(1));
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
  return tags;
}

struct Vti {
  std::string header, data, footer;
};

/// Splits at the appended data by its own byte count.
Vti splitVti(const fs::path& path) {
  const std::string text = test::read(path);
  const std::string mark = "<AppendedData encoding=\"raw\">\n   _";
  const std::size_t at = text.find(mark);
  EXPECT_NE(at, std::string::npos);
  const std::size_t first = at + mark.size();
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, text.data() + first, sizeof bytes);
  return {text.substr(0, first - 1), text.substr(first + 8, bytes), text.substr(first + 8 + bytes)};
}

} // namespace

RC_GTEST_PROP(hbVolumeWriter, NrrdComesBackTheSame, ()) {
  hbGeometry g;
  for (int d = 0; d < 3; ++d) {
    g.size[d] = *rc::gen::inRange<std::int64_t>(1, 6);
    g.origin[d] = double(*rc::gen::inRange(-100000, 100000)) / 997.0;
    g.spacing[d] = double(*rc::gen::inRange(1, 100000)) / 991.0;
  }
  // A rotation by a quaternion, with a flip now and then.
  glm::dvec4 q(*rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10), 5.0);
  q /= glm::length(q);
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  g.direction = glm::dmat3(glm::dvec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
                           glm::dvec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
                           glm::dvec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)));
  if (*rc::gen::arbitrary<bool>()) g.direction[0] = -g.direction[0];
  g.centring = *rc::gen::element(hbGeometry::Centring::node, hbGeometry::Centring::cell);
  g.space = *rc::gen::element(std::string(), std::string("left-posterior-superior"), std::string("scanner-xyz"));
  const int components = *rc::gen::inRange(1, 4);
  const auto type = hbSampleType(*rc::gen::inRange(1, 9));
  const auto path = fs::path(::testing::TempDir()) / "hbvol-roundtrip.nrrd";

  hb::withSampleType(type, [&](auto tag) {
    using T = decltype(tag);
    const auto samples =
        *rc::gen::container<std::vector<T>>(std::size_t(g.samples() * components), rc::gen::arbitrary<T>());
    hbVolume written = hbVolume::fromSamples<T>(g, samples, components);
    std::vector<std::string> names(static_cast<std::size_t>(components));
    names[0] = *rc::gen::element(std::string(), std::string("speed"), std::string("a \\ b\nc: =d"));
    written.setComponentNames(names);
    hb::writeVolume(written, path);
    const hbVolume read = hb::readVolume(path);
    RC_ASSERT(read.type() == type);
    RC_ASSERT(read.components() == components);
    RC_ASSERT(read.componentNames() == names);
    const hbGeometry& r = read.geometry();
    RC_ASSERT(r.size == g.size);
    RC_ASSERT(r.origin == g.origin); // printed exactly
    RC_ASSERT(r.centring == g.centring);
    RC_ASSERT(r.space == g.space);
    for (int d = 0; d < 3; ++d) {
      // spacing * direction is rounded once a coordinate; its length takes three squares, two sums and a root; the
      // direction was a unit vector up to some 8 eps itself: together below 32 eps.
      constexpr double kTolerance = 32 * 2.3e-16;
      RC_ASSERT(std::abs(r.spacing[d] - g.spacing[d]) <= kTolerance * g.spacing[d]);
      RC_ASSERT(glm::length(r.direction[d] - g.direction[d]) <= kTolerance);
    }
    RC_ASSERT(std::memcmp(read.data(), samples.data(), samples.size() * sizeof(T)) == 0);
  });
}

TEST(hbVolumeWriter, NrrdHeaderIsTheFormats) {
  const auto path = test::folder() / "a.nrrd";
  hbGeometry g = oblique({2, 1, 3});
  g.centring = hbGeometry::Centring::cell;
  hb::writeVolume(hbVolume::fromSamples<float>(g, std::vector<float>(12), 2), path);
  const std::string text = test::read(path);
  EXPECT_EQ(text.substr(0, text.find("\n\n")),
            "NRRD0005\n"
            "type: float\n"
            "dimension: 4\n"
            "space: left-posterior-superior\n"
            "sizes: 2 2 1 3\n"
            "space directions: none (0.06,0.08000000000000002,0) (1.6,-1.2,0) (0,0,3.5)\n"
            "centers: ??? cell cell cell\n"
            "kinds: list domain domain domain\n"
            "endian: little\n"
            "encoding: raw\n"
            "space origin: (1.25,-7,0.001)");
  EXPECT_EQ(text.size(), text.find("\n\n") + 2 + 12 * sizeof(float));
}

TEST(hbVolumeWriter, VtiOfNodes) {
  const auto path = test::folder() / "a.vti";
  const auto samples = test::ramp<std::uint16_t>(24, 60000);
  auto volume = hbVolume::fromSamples<std::uint16_t>(oblique({2, 3, 4}), samples);
  volume.setComponentNames({"a<b> & \"c\"\t\xC3\xA4"});
  hb::writeVolume(volume, path);
  const Vti vti = splitVti(path);
  EXPECT_EQ(checkNesting(vti.header + vti.footer), 12);
  EXPECT_EQ(attribute(vti.header, "byte_order"), "LittleEndian");
  EXPECT_EQ(attribute(vti.header, "header_type"), "UInt64");
  EXPECT_EQ(attribute(vti.header, "WholeExtent"), "0 1 0 2 0 3");
  EXPECT_EQ(attribute(vti.header, "Extent"), "0 1 0 2 0 3");
  EXPECT_EQ(attribute(vti.header, "Origin"), "1.25 -7 0.001");
  EXPECT_EQ(attribute(vti.header, "Spacing"), "0.1 2 3.5");
  EXPECT_EQ(attribute(vti.header, "Direction"), "0.6 0.8 0 0.8 -0.6 0 0 0 1");
  EXPECT_EQ(attribute(vti.header, "type"), "ImageData");
  EXPECT_NE(vti.header.find("<DataArray type=\"UInt16\" Name=\"a&lt;b&gt; &amp; &quot;c&quot;___\""),
            std::string::npos);
  EXPECT_LT(vti.header.find("<PointData>"), vti.header.find("<DataArray"));
  EXPECT_EQ(vti.data, test::bytes(samples));
}

TEST(hbVolumeWriter, VtiOfCellsIsHalfAVoxelLarger) {
  const auto path = test::folder() / "a.vti";
  hbGeometry g = oblique({2, 3, 1});
  g.centring = hbGeometry::Centring::cell;
  auto volume = hbVolume::fromSamples<double>(g, test::ramp<double>(12), 2);
  volume.setComponentNames({"u", "v"});
  hb::writeVolume(volume, path);
  const Vti vti = splitVti(path);
  EXPECT_EQ(attribute(vti.header, "WholeExtent"), "0 2 0 3 0 1");
  EXPECT_LT(vti.header.find("<CellData>"), vti.header.find("<DataArray type=\"Float64\""));
  EXPECT_EQ(attribute(vti.header, "NumberOfComponents"), "2");
  EXPECT_EQ(attribute(vti.header, "ComponentName0"), "u");
  EXPECT_EQ(attribute(vti.header, "ComponentName1"), "v");
  // The centre of the first cell is the first sample.
  glm::dvec3 origin;
  ASSERT_EQ(std::sscanf(attribute(vti.header, "Origin").c_str(), "%lf %lf %lf", &origin.x, &origin.y, &origin.z), 3);
  // Coordinates of at most 8 and two sums: below 1e-14.
  EXPECT_LT(glm::length(origin + g.direction * (0.5 * g.spacing) - g.origin), 1e-14);
  EXPECT_EQ(vti.data, test::bytes(test::ramp<double>(12)));
}

TEST(hbVolumeWriter, TypesOfVti) {
  const auto dir = test::folder();
  const char* names[] = {"Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Float32", "Float64"};
  for (int t = 1; t <= 8; ++t)
    hb::withSampleType(hbSampleType(t), [&](auto tag) {
      hb::writeVolume(hbVolume::fromSamples<decltype(tag)>({}, {tag}), dir / "a.vti");
      EXPECT_NE(test::read(dir / "a.vti").find(fmt::format("DataArray type=\"{}\"", names[t - 1])), std::string::npos);
    });
}

TEST(hbVolumeWriter, RawIsTheSamplesUnderATellingName) {
  const auto dir = test::folder();
  const auto samples = test::ramp<std::int32_t>(24, -5);
  const auto volume = hbVolume::fromSamples<std::int32_t>(oblique({2, 3, 4}), samples);
  hb::writeVolume(volume, dir / "a_2x3x4_int32.raw");
  EXPECT_EQ(test::read(dir / "a_2x3x4_int32.raw"), test::bytes(samples));
  EXPECT_ERROR(hb::writeVolume(volume, dir / "my_head.raw"), "as in my_head_2x3x4_int32.raw");
  EXPECT_ERROR(hb::writeVolume(volume, dir / "b_4x3x2_int32.raw"), "as in b_2x3x4_int32.raw");
  EXPECT_ERROR(hb::writeVolume(volume, dir / "b_2x3x4_uint32.raw"), "as in b_2x3x4_int32.raw");
  const auto two = hbVolume::fromSamples<std::int32_t>(oblique({2, 3, 2}), samples, 2);
  EXPECT_ERROR(hb::writeVolume(two, dir / "c_2x3x2_int32.raw"), "expected one component");
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), {}), 1);
}

TEST(hbVolumeWriter, FollowsAnyLayout) {
  // Planar, z fastest, big-endian in; packed, x fastest, little-endian out.
  const auto dir = test::folder();
  hbRawLayout layout;
  layout.size = {2, 3, 4};
  layout.type = hbSampleType::uint16;
  layout.bigEndian = true;
  layout.axisOrder = "zyx";
  layout.components = 2;
  layout.interleaving = hbRawLayout::Interleaving::planar;
  const hbVolume in =
      hb::openRawFile(test::write(dir / "in.bin", test::bytes(test::ramp<std::uint16_t>(48), true)), layout);
  hb::writeVolume(in, dir / "out.nrrd");
  const hbVolume out = hb::readVolume(dir / "out.nrrd");
  EXPECT_EQ(out.layout(), hbVolume::Layout::packed(layout.size, 2));
  for (int c = 0; c < 2; ++c)
    for (int z = 0; z < 4; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 2; ++x) ASSERT_EQ(out.value(x, y, z, c), z + 4 * y + 12 * x + 24 * c);
}

TEST(hbVolumeWriter, AppliesSlopeAndIntercept) {
  const auto dir = test::folder();
  auto narrow = hbVolume::fromSamples<std::int16_t>(test::sized(2, 1, 1), {-3, 1000, 4, 5}, 2);
  narrow.setSlopeIntercept(0.5, 10.0);
  hb::writeVolume(narrow, dir / "a.nrrd");
  const hbVolume read = hb::readVolume(dir / "a.nrrd");
  EXPECT_EQ(read.type(), hbSampleType::float32);
  EXPECT_EQ(read.value(0, 0, 0, 0), 8.5);
  EXPECT_EQ(read.value(0, 0, 0, 1), 510.0);
  EXPECT_EQ(read.value(1, 0, 0, 1), 12.5);
  auto wide = hbVolume::fromSamples<std::int32_t>({}, {2000000001});
  wide.setSlopeIntercept(1.0, 1.0);
  hb::writeVolume(wide, dir / "b.nrrd");
  const hbVolume exact = hb::readVolume(dir / "b.nrrd");
  EXPECT_EQ(exact.type(), hbSampleType::float64);
  EXPECT_EQ(exact.value(0, 0, 0), 2000000002.0);
}

TEST(hbVolumeWriter, RefusesBeforeAnythingIsWritten) {
  const auto dir = test::folder();
  const auto volume = hbVolume::fromSamples<std::uint8_t>({}, {1});
  EXPECT_ERROR(hb::writeVolume(volume, dir / "a.mha"), "expected a volume file to write, .nrrd, .vti or .raw");
  EXPECT_ERROR(hb::writeVolume(volume, dir / "a"), ".nrrd, .vti or .raw");
  EXPECT_ERROR(hb::writeVolume(volume, dir / "missing" / "a.nrrd"), "cannot be written");
  fs::create_directory(dir / "b.nrrd");
  EXPECT_ERROR(hb::writeVolume(volume, dir / "b.nrrd"), "a folder");
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::writeVolume(volume, dir / "c.nrrd", progress), hbCancelled);
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), {}), 1);
}

TEST(hbVolumeStream, TakesPiecesOfAnySize) {
  const auto path = test::folder() / "a.nrrd";
  const auto samples = test::ramp<std::uint16_t>(24);
  const auto bytes = std::as_bytes(std::span(samples));
  hbVolumeStream stream(path, oblique({2, 3, 4}), hbSampleType::uint16, 1);
  EXPECT_EQ(stream.bytes(), 48U);
  stream.write(bytes.first(7));
  stream.write(bytes.subspan(7, 0));
  stream.write(bytes.subspan(7));
  EXPECT_FALSE(fs::exists(path));
  stream.commit();
  const hbVolume read = hb::readVolume(path);
  EXPECT_EQ(std::memcmp(read.data(), samples.data(), 48), 0);
}

TEST(hbVolumeStream, CountsItsSamples) {
  const auto dir = test::folder();
  const std::vector<std::byte> ten(10);
  {
    hbVolumeStream stream(dir / "a.nrrd", test::sized(5, 1, 1), hbSampleType::uint16, 1);
    stream.write(std::span(ten).first(8));
    EXPECT_ERROR(stream.commit(), "expected 10 bytes of samples, found 8");
    EXPECT_ERROR(stream.write(ten), "expected 10 bytes of samples, found more");
  }
  EXPECT_TRUE(fs::is_empty(dir));
  EXPECT_ERROR(hbVolumeStream(dir / "a.nrrd", {}, hbSampleType::uint8, 0), "component");
  EXPECT_ERROR(hbVolumeStream(dir / "a.nrrd", {}, hbSampleType::uint8, 1, {"a", "b"}), "names");
  EXPECT_ERROR(hbVolumeStream(dir / "a.nrrd", test::sized(1 << 19, 1 << 20, 1 << 20), hbSampleType::float64, 1 << 10),
               "2^63");
  EXPECT_ERROR(hbVolumeStream(dir / "a.nrrd", test::sized(0, 1, 1), hbSampleType::uint8, 1), "at least one node");
}

TEST(hbVolumeStream, ReportsAFullDisk) {
  const auto dir = test::folder();
  hbVolumeStream stream(dir / "a_1048576x1x1_uint8.raw", test::sized(1 << 20, 1, 1), hbSampleType::uint8, 1);
  // A limit on the size of files stands for the end of the disk; its signal would end the process.
  struct rlimit before {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small { 4096, before.rlim_max };
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::vector<std::byte> samples(1 << 20);
  const std::string message = test::errorOf([&] { stream.write(samples); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(message.find("cannot be written: File too large"), std::string::npos) << message;
}
