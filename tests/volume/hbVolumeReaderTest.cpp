#include "volume/hbVolumeReader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <itkGDCMImageIO.h>
#include <itkMetaDataObject.h>
#include <itkTIFFImageIO.h>
#include <zlib.h>

#include "tests/volume/testFiles.h"

namespace fs = std::filesystem;

/// For the leak sanitizer: teem, inside ITK, does not free what it had when it fails.
extern "C" const char* __lsan_default_suppressions() { // NOLINT: the sanitizer's name
  return "leak:libITKNrrdIO\n";
}

namespace {

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY); // 16: a gzip header
  std::string result(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = uInt(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

/// All data values, components side by side.
std::vector<double> valuesOf(const hbVolume& volume) {
  std::vector<double> result;
  const hbSize3 size = volume.geometry().size;
  for (std::int64_t z = 0; z < size.z; ++z)
    for (std::int64_t y = 0; y < size.y; ++y)
      for (std::int64_t x = 0; x < size.x; ++x)
        for (int c = 0; c < volume.components(); ++c) result.push_back(volume.value(x, y, z, c));
  return result;
}

template <class T>
std::vector<double> doubles(const std::vector<T>& samples) {
  return {samples.begin(), samples.end()};
}

glm::dvec3 worldOf(const hbGeometry& g, double i, double j, double k) {
  return g.origin + g.direction * (g.spacing * glm::dvec3(i, j, k));
}

/// A header of NRRD with the given lines, the samples of 2 x 3 x 4 uint8 behind it.
std::string nrrd(const std::string& lines) {
  return "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: raw\n" + lines + "\n" +
         test::bytes(test::ramp<std::uint8_t>(24));
}

hbVolume readText(const fs::path& dir, const std::string& name, const std::string& text) {
  return hb::readVolume(test::write(dir / name, text));
}

/// A NIfTI-1 header and its four bytes of no extension (nifti1.h); 2 x 3 x 4 samples, millimetres.
struct Nifti {
  std::string bytes = std::string(352, '\0');

  template <class T>
  Nifti& set(std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return *this;
  }
  Nifti(std::int16_t type, std::int16_t bits) {
    set<std::int32_t>(0, 348);
    dims({3, 2, 3, 4, 1, 1, 1, 1});
    set<std::int16_t>(70, type).set<std::int16_t>(72, bits);
    for (std::size_t d = 0; d < 8; ++d) set<float>(76 + 4 * d, 1.0F); // pixdim
    set<float>(108, 352.0F).set<std::uint8_t>(123, 2);
    std::memcpy(bytes.data() + 344, "n+1", 4);
    // sform: x' = -2 i + 10, y' = 3 j + 20, z' = 4 k + 30 in RAS
    set<std::int16_t>(254, 1);
    const float rows[12] = {-2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30};
    for (std::size_t i = 0; i < 12; ++i) set<float>(280 + 4 * i, rows[i]);
    for (std::size_t d = 1; d < 4; ++d) set<float>(76 + 4 * d, float(d + 1));
  }
  Nifti& dims(const std::vector<std::int16_t>& values) {
    for (std::size_t d = 0; d < 8; ++d) set<std::int16_t>(40 + 2 * d, values[d]);
    return *this;
  }
};

/// Writes an image through ITK.
template <class Io, class T>
void writeItk(const fs::path& path, const std::vector<unsigned>& sizes, itk::IOComponentEnum type,
              const std::vector<T>& samples, unsigned components = 1, const std::vector<double>& spacing = {}) {
  const auto io = Io::New();
  io->SetFileName(path.string());
  io->SetNumberOfDimensions(unsigned(sizes.size()));
  itk::ImageIORegion region(unsigned(sizes.size()));
  for (unsigned d = 0; d < sizes.size(); ++d) {
    io->SetDimensions(d, sizes[d]);
    io->SetSpacing(d, spacing.empty() ? 1.0 : spacing[d]);
    region.SetSize(d, sizes[d]);
  }
  io->SetIORegion(region);
  io->SetComponentType(type);
  io->SetPixelType(components == 1 ? itk::IOPixelEnum::SCALAR : itk::IOPixelEnum::RGB);
  io->SetNumberOfComponents(components);
  io->SetUseCompression(false);
  if constexpr (std::is_same_v<Io, itk::TIFFImageIO>) io->SetCompressor("NOCOMPRESSION");
  io->WriteImageInformation();
  io->Write(samples.data());
}

/// One DICOM slice of 4 x 3 int16 at z, written through ITK.
void writeSlice(const fs::path& path, double z, const std::string& series, std::int16_t first, unsigned rows = 3) {
  const auto io = itk::GDCMImageIO::New();
  io->SetFileName(path.string());
  io->SetNumberOfDimensions(2);
  io->SetDimensions(0, 4);
  io->SetDimensions(1, rows);
  io->SetSpacing(0, 0.5);
  io->SetSpacing(1, 0.75);
  io->SetComponentType(itk::IOComponentEnum::SHORT);
  io->SetPixelType(itk::IOPixelEnum::SCALAR);
  io->SetNumberOfComponents(1);
  io->SetUseCompression(false);
  io->KeepOriginalUIDOn();
  itk::MetaDataDictionary& tags = io->GetMetaDataDictionary();
  const auto tag = [&](const char* name, const std::string& value) {
    itk::EncapsulateMetaData<std::string>(tags, name, value);
  };
  tag("0008|0016", "1.2.840.10008.5.1.4.1.1.2"); // CT image storage
  tag("0008|0018", fmt::format("{}.{}", series, first + 1));
  tag("0008|0060", "CT");
  tag("0020|000d", "1.2.3");
  tag("0020|000e", series);
  tag("0020|0032", fmt::format("10\\20\\{}", z));
  tag("0020|0037", "1\\0\\0\\0\\1\\0");
  itk::ImageIORegion region(2);
  region.SetSize(0, 4);
  region.SetSize(1, rows);
  io->SetIORegion(region);
  io->WriteImageInformation();
  const auto samples = test::ramp<std::int16_t>(4 * rows, first);
  io->Write(samples.data());
}

} // namespace

// NRRD

TEST(hbVolumeReader, NrrdPlain) {
  const hbVolume v = readText(test::folder(), "a.nrrd", nrrd("# comment\nspacings: 0.5 -2 nan\n"));
  EXPECT_EQ(v.type(), hbSampleType::uint8);
  EXPECT_EQ(v.geometry().size, hbSize3(2, 3, 4));
  EXPECT_EQ(valuesOf(v), doubles(test::ramp<std::uint8_t>(24)));
  EXPECT_EQ(v.geometry().space, "");
  EXPECT_EQ(v.geometry().centring, hbGeometry::Centring::node);
  EXPECT_EQ(v.geometry().spacing, glm::dvec3(0.5, 2.0, 1.0));
  EXPECT_EQ(v.geometry().direction[1], glm::dvec3(0.0, -1.0, 0.0));
  EXPECT_EQ(v.geometry().origin, glm::dvec3(0.0));
}

TEST(hbVolumeReader, NrrdAxisMinimaAndCentring) {
  const auto dir = test::folder();
  const hbVolume cell =
      readText(dir, "a.nrrd", nrrd("centerings: cell cell cell\naxis mins: 10 20 30\naxis maxs: 14 26 38\n"));
  EXPECT_EQ(cell.geometry().centring, hbGeometry::Centring::cell);
  EXPECT_EQ(cell.geometry().spacing, glm::dvec3(2.0));
  EXPECT_EQ(cell.geometry().origin, glm::dvec3(11.0, 21.0, 31.0));
  const hbVolume node =
      readText(dir, "b.nrrd", nrrd("centers: node node node\naxis mins: 10 20 30\naxis maxs: 14 26 39\n"));
  EXPECT_EQ(node.geometry().centring, hbGeometry::Centring::node);
  EXPECT_EQ(node.geometry().spacing, glm::dvec3(4.0, 3.0, 3.0));
  EXPECT_EQ(node.geometry().origin, glm::dvec3(10.0, 20.0, 30.0));
  EXPECT_EQ(readText(dir, "c.nrrd", nrrd("centers: node cell cell\n")).geometry().centring, hbGeometry::Centring::node);
  EXPECT_EQ(readText(dir, "d.nrrd", nrrd("centers: ??? cell cell\n")).geometry().centring, hbGeometry::Centring::cell);
}

TEST(hbVolumeReader, NrrdSpacesLandAtTheSamePlaceInLps) {
  // One box given in three worlds: the samples' places in LPS must agree.
  const auto dir = test::folder();
  const auto place = [&](const std::string& space, double x, double y) {
    const hbVolume v = readText(
        dir, space + ".nrrd",
        nrrd(fmt::format("space: {}\nspace directions: ({},{},0) ({},{},0.5) (0,0,3)\nspace origin: ({},{},7)\n", space,
                         x * 1.0, y * 2.0, x * -2.0, y * 1.0, x * 5.0, y * 6.0)));
    EXPECT_EQ(v.geometry().space, "left-posterior-superior");
    return worldOf(v.geometry(), 1, 2, 3);
  };
  const glm::dvec3 expected(5.0 + 1.0 - 4.0, 6.0 + 2.0 + 2.0, 7.0 + 1.0 + 9.0);
  // Lengths, quotients and products of coordinates up to 17: below 1e-14.
  EXPECT_LT(glm::length(place("left-posterior-superior", 1, 1) - expected), 1e-14);
  EXPECT_LT(glm::length(place("LPS", 1, 1) - expected), 1e-14);
  EXPECT_LT(glm::length(place("right-anterior-superior", -1, -1) - expected), 1e-14);
  EXPECT_LT(glm::length(place("RAS", -1, -1) - expected), 1e-14);
  EXPECT_LT(glm::length(place("left-anterior-superior", 1, -1) - expected), 1e-14);
  const hbVolume other =
      readText(dir, "other.nrrd",
               nrrd("space: scanner-xyz\nspace directions: (1,0,0) (0,-2,0) (0,0,3)\nspace origin: (1,2,3)\n"));
  EXPECT_EQ(other.geometry().space, "scanner-xyz");
  EXPECT_EQ(worldOf(other.geometry(), 1, 1, 1), glm::dvec3(2.0, 0.0, 6.0));
  const hbVolume unnamed =
      readText(dir, "unnamed.nrrd", nrrd("space dimension: 3\nspace directions: (1,0,0) (0,-2,0) (0,0,3)\n"));
  EXPECT_EQ(unnamed.geometry().space, "");
}

TEST(hbVolumeReader, NrrdDetachedAndSkips) {
  const auto dir = test::folder();
  const auto samples = test::ramp<std::uint16_t>(24, 1000);
  const std::string header = "NRRD0004\r\ntype: ushort\r\ndimension: 3\r\nsizes: 2 3 4\r\n";
  test::write(dir / "a.raw.gz", gzipped(test::bytes(samples)));
  EXPECT_EQ(valuesOf(readText(dir, "a.nhdr", header + "encoding: gzip\r\nendian: little\r\ndata file: a.raw.gz\r\n")),
            doubles(samples));
  test::write(dir / "b.raw", "one\ntwo\n123" + test::bytes(samples, true));
  const std::string raw = header + "encoding: raw\nendian: big\n";
  const hbVolume mapped = readText(dir, "b.nhdr", raw + "line skip: 2\nbyte skip: 3\ndata file: b.raw\n");
  EXPECT_EQ(valuesOf(mapped), doubles(samples));
  EXPECT_TRUE(mapped.layout().byteSwapped);
  EXPECT_EQ(valuesOf(readText(dir, "c.nhdr", raw + "byte skip: -1\ndata file: b.raw\n")), doubles(samples));
  // One file a slice.
  std::string list = header + "encoding: raw\nendian: little\ndata file: LIST\n";
  for (std::size_t z = 0; z < 4; ++z) {
    test::write(dir / fmt::format("d{}.raw", z), test::bytes(samples).substr(12 * z, 12));
    list += fmt::format("d{}.raw\n", z);
  }
  EXPECT_EQ(valuesOf(readText(dir, "d.nhdr", list)), doubles(samples));
  EXPECT_ERROR(readText(dir, "e.nhdr", raw + "line skip: 9\ndata file: b.raw\n"), "skipping line 4 of 9");
  EXPECT_ERROR(readText(dir, "f.nhdr", raw + "data file: missing.raw\n"), "missing.raw");
  EXPECT_ERROR(readText(dir, "g.nhdr", raw + "data file: d%d.raw 0 1 1\n"), "pattern");
  fs::remove(dir / "d1.raw");
  EXPECT_ERROR(readText(dir, "d.nhdr", list), "d1.raw");
}

TEST(hbVolumeReader, NrrdTextEncodings) {
  const auto dir = test::folder();
  const std::string header = "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 1\n";
  const std::vector<double> expected{-1, 2, 300, 4};
  EXPECT_EQ(valuesOf(readText(dir, "a.nrrd", header + "encoding: ascii\n\n-1 2\n300 4\n")), expected);
  EXPECT_EQ(valuesOf(readText(dir, "b.nrrd", header + "encoding: hex\nendian: little\n\nffff02002c010400\n")),
            expected);
  EXPECT_ERROR(readText(dir, "c.nrrd", header + "encoding: ascii\n\n-1 2\n300\n"), "c.nrrd");
  EXPECT_ERROR(readText(dir, "d.nrrd", header + "encoding: hex\nendian: little\n\nffff02002c\n"), "d.nrrd");
}

TEST(hbVolumeReader, NrrdComponentsOnAnyAxis) {
  const auto dir = test::folder();
  // Value of sample (x,y,z), component c: x + 2 y + 6 z + 24 c.
  std::vector<std::int32_t> first, last, expected;
  for (int i = 0; i < 24; ++i)
    for (int c = 0; c < 3; ++c) first.push_back(i + 24 * c);
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 24; ++i) last.push_back(i + 24 * c);
  const std::string header = "NRRD0005\ntype: int\ndimension: 4\nendian: little\n";
  for (const bool gzip : {false, true}) {
    const auto body = [&](const auto& samples) {
      return gzip ? "encoding: gzip\n\n" + gzipped(test::bytes(samples)) : "encoding: raw\n\n" + test::bytes(samples);
    };
    const hbVolume a =
        readText(dir, "a.nrrd",
                 header + "sizes: 3 2 3 4\nkinds: vector domain domain domain\nspacings: nan 1 2 3\n" + body(first));
    EXPECT_EQ(a.components(), 3);
    EXPECT_EQ(a.geometry().size, hbSize3(2, 3, 4));
    EXPECT_EQ(a.geometry().spacing, glm::dvec3(1, 2, 3));
    EXPECT_EQ(valuesOf(a), doubles(first));
    const hbVolume b =
        readText(dir, "b.nrrd", header + "sizes: 2 3 4 3\nkinds: domain domain domain list\n" + body(last));
    EXPECT_EQ(b.components(), 3);
    EXPECT_EQ(valuesOf(b), doubles(first));
  }
  // A masked tensor of seven values comes without its mask.
  std::vector<float> tensors = test::ramp<float>(14);
  const hbVolume t = readText(dir, "t.nrrd",
                              "NRRD0005\ntype: float\ndimension: 4\nendian: little\nsizes: 7 2 1 1\nkinds: "
                              "3D-masked-symmetric-matrix domain domain domain\nencoding: raw\n\n" +
                                  test::bytes(tensors));
  EXPECT_EQ(t.components(), 6);
  EXPECT_EQ(t.value(0, 0, 0, 0), 1.0);
  EXPECT_EQ(t.value(1, 0, 0, 5), 13.0);
}

TEST(hbVolumeReader, NrrdFlatAndMoreThanThreeDimensions) {
  const auto dir = test::folder();
  const std::string header = "NRRD0004\ntype: uint8\nencoding: raw\n";
  const hbVolume two = readText(dir, "a.nrrd",
                                header +
                                    "dimension: 2\nsizes: 2 3\nspace dimension: 2\nspace directions: (0,2) "
                                    "(-3,0)\nspace origin: (5,6)\n\n" +
                                    std::string(6, 'a'));
  EXPECT_EQ(two.geometry().size, hbSize3(2, 3, 1));
  EXPECT_EQ(worldOf(two.geometry(), 1, 2, 0), glm::dvec3(5 - 6, 6 + 2, 0));
  const hbVolume one =
      readText(dir, "b.nrrd", header + "dimension: 1\nsizes: 6\nspacings: 2\n\n" + std::string(6, 'a'));
  EXPECT_EQ(one.geometry().size, hbSize3(6, 1, 1));
  const hbVolume still = readText(dir, "c.nrrd", header + "dimension: 4\nsizes: 2 3 1 1\n\n" + std::string(6, 'a'));
  EXPECT_EQ(still.geometry().size, hbSize3(2, 3, 1));
  EXPECT_ERROR(readText(dir, "d.nrrd", header + "dimension: 4\nsizes: 1 2 1 3\n\n" + std::string(6, 'a')),
               "1 x 2 x 1 x 3");
}

TEST(hbVolumeReader, NrrdDamage) {
  const auto dir = test::folder();
  const std::string good = nrrd("");
  for (std::size_t cut = 0; cut < good.size(); ++cut) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.nrrd", good.substr(0, cut)); });
    ASSERT_NE(message.find("cut.nrrd"), std::string::npos) << cut;
  }
  EXPECT_ERROR(readText(dir, "a.nrrd", good.substr(0, good.size() - 1)),
               "expected at least 24 bytes of samples, found 23");
  const auto header = [](const std::string& lines) { return "NRRD0005\ntype: uint8\n" + lines + "\n" + "samples"; };
  EXPECT_ERROR(readText(dir, "b.nrrd", header("dimension: 3\nsizes: 1152921504606846976 1 1\nencoding: raw\n")),
               "2^60");
  EXPECT_ERROR(readText(dir, "c.nrrd", header("dimension: 3\nsizes: 1048576 1048576 524288\nencoding: raw\n")),
               "expected at least 576460752303423488 bytes of samples, found 7");
  EXPECT_ERROR(readText(dir, "d.nrrd", header("dimension: 3\nsizes: 1048576 1048576 524288\nencoding: gzip\n")),
               "compressed bytes cannot hold");
  EXPECT_ERROR(readText(dir, "e.nrrd", header("dimension: 3\nsizes: 99999999999999999999 1 1\nencoding: raw\n")),
               "2^63");
  EXPECT_ERROR(readText(dir, "f.nrrd", header("dimension: 3\nsizes: 2 0 3\nencoding: raw\n")), "2 x 0 x 3");
  EXPECT_ERROR(readText(dir, "g.nrrd", header("dimension: 3\nsizes: 2 2\nencoding: raw\n")), "g.nrrd");
  EXPECT_ERROR(readText(dir, "h.nrrd", header("dimension: 3\nencoding: raw\n")), "sizes");
  EXPECT_ERROR(readText(dir, "i.nrrd", header("dimension: 1\nsizes: 2\nencoding: zip\n")), "'zip'");
  EXPECT_ERROR(readText(dir, "j.nrrd", header("nonsense\n")), "'nonsense'");
  EXPECT_ERROR(readText(dir, "k.nrrd", "P5 1 1 255 a"), "expected an NRRD file");
  EXPECT_ERROR(readText(dir, "l.nrrd", nrrd("spacings: 1 x 1\n")), "'x'");
  EXPECT_ERROR(readText(dir, "m.nrrd", nrrd("spacings: 1 1\n")), "expected 3 numbers, found 2");
  EXPECT_ERROR(readText(dir, "n.nrrd", nrrd("space: LPS\nspace directions: (1,0,0) (0,1,0 (0,0,1)\n")), "vectors");
  EXPECT_ERROR(readText(dir, "o.nrrd", nrrd("space: LPS\nspace directions: (1,0,0) (0,1,0)\n")), "found 2");
  EXPECT_ERROR(readText(dir, "p.nrrd", nrrd("space: LPS\nspace directions: (1,0,0) (2,0,0) (0,0,1)\n")), "independent");
  EXPECT_ERROR(readText(dir, "q.nrrd", nrrd("space: LPS\nspace directions: (1,0,0) (0,0,0) (0,0,1)\n")), "axis 1");
  EXPECT_ERROR(readText(dir, "r.nrrd", nrrd("byte skip: -2\n")), "byte skip");
  EXPECT_ERROR(readText(dir, "s.nrrd", nrrd("byte skip: x\n")), "'x'");
  EXPECT_ERROR(readText(dir, "t.nrrd", nrrd("kinds: list vector domain\n")), "one axis of components");
  EXPECT_ERROR(readText(dir, "u.nrrd", header("dimension: 2\nsizes: 1000000 1\nkinds: list domain\nencoding: raw\n")),
               "65536 components");
  const std::string compressed = gzipped(test::bytes(test::ramp<std::uint8_t>(200)));
  EXPECT_ERROR(readText(dir, "v.nrrd",
                        "NRRD0005\ntype: uint8\ndimension: 1\nsizes: 200\nencoding: gzip\n\n" +
                            compressed.substr(0, compressed.size() / 2)),
               "v.nrrd");
}

TEST(hbVolumeReader, IntegersOf64Bits) {
  const auto dir = test::folder();
  const auto with = [&](const std::string& type, const auto& samples) {
    return readText(dir, "a.nrrd",
                    "NRRD0005\ntype: " + type +
                        "\ndimension: 1\nsizes: 2\nendian: little\nencoding: "
                        "raw\n\n" +
                        test::bytes(samples));
  };
  const hbVolume v = with("int64", std::vector<std::int64_t>{-2147483648, 2147483647});
  EXPECT_EQ(v.type(), hbSampleType::int32);
  EXPECT_EQ(valuesOf(v), (std::vector<double>{-2147483648.0, 2147483647.0}));
  const hbVolume u = with("uint64", std::vector<std::uint64_t>{0, 4294967295});
  EXPECT_EQ(u.type(), hbSampleType::uint32);
  EXPECT_EQ(valuesOf(u), (std::vector<double>{0.0, 4294967295.0}));
  EXPECT_ERROR(with("int64", std::vector<std::int64_t>{0, 2147483648}), "found 2147483648");
  EXPECT_ERROR(with("uint64", std::vector<std::uint64_t>{4294967296, 0}), "found 4294967296");
}

// MetaImage

TEST(hbVolumeReader, MetaImage) {
  const auto dir = test::folder();
  const auto samples = test::ramp<std::int16_t>(24, -3);
  const std::string header = "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = 2 3 4\nElementType = "
                             "MET_SHORT\nElementSpacing = 1 2 3\nOffset = 10 20 30\nTransformMatrix = 0 1 0 -1 0 0 0 0 "
                             "-1\nAnatomicalOrientation = RAI\n";
  const hbVolume v = readText(dir, "a.mha", header + "ElementDataFile = LOCAL\n" + test::bytes(samples));
  EXPECT_EQ(v.type(), hbSampleType::int16);
  EXPECT_EQ(valuesOf(v), doubles(samples));
  EXPECT_EQ(v.geometry().space, "left-posterior-superior");
  EXPECT_EQ(worldOf(v.geometry(), 1, 1, 1), glm::dvec3(10 - 2, 20 + 1, 30 - 3));
  EXPECT_EQ(v.geometry().spacing, glm::dvec3(1, 2, 3));

  test::write(dir / "b.raw", "12345" + test::bytes(samples, true));
  EXPECT_EQ(valuesOf(readText(dir, "b.mhd",
                              header + "BinaryDataByteOrderMSB = True\nHeaderSize = 5\nElementDataFile = "
                                       "b.raw\n")),
            doubles(samples));
  EXPECT_EQ(valuesOf(readText(dir, "c.mhd",
                              header + "BinaryDataByteOrderMSB = True\nHeaderSize = -1\nElementDataFile "
                                       "= b.raw\n")),
            doubles(samples));
  std::string zipped(1000, '\0');
  uLongf length = zipped.size();
  const std::string bytes = test::bytes(samples);
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(zipped.data()), &length, reinterpret_cast<const Bytef*>(bytes.data()),
                     bytes.size()),
            Z_OK);
  zipped.resize(length);
  const std::string compressed =
      header + fmt::format("CompressedData = True\nCompressedDataSize = {}\nElementDataFile = LOCAL\n", length);
  EXPECT_EQ(valuesOf(readText(dir, "d.mha", compressed + zipped)), doubles(samples));
  EXPECT_EQ(valuesOf(readText(dir, "e.mha",
                              "NDims = 2\nDimSize = 2 2\nElementType = MET_UCHAR\nElementNumberOfChannels "
                              "= 3\nElementDataFile = LOCAL\nabcdefghijkl")),
            doubles(test::ramp<std::uint8_t>(12, 'a')));
  EXPECT_EQ(valuesOf(readText(dir, "f.mha",
                              "NDims = 2\nDimSize = 2 2\nElementType = MET_FLOAT\nBinaryData = "
                              "False\nElementDataFile = LOCAL\n1 2.5\n-3 4e2\n")),
            (std::vector<double>{1, 2.5, -3, 400}));
  EXPECT_EQ(readText(dir, "g.mha", "NDims = 1\nDimSize = 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\nab")
                .geometry()
                .space,
            "");
}

TEST(hbVolumeReader, MetaImageDamage) {
  const auto dir = test::folder();
  const std::string start = "ObjectType = Image\nNDims = 3\nElementType = MET_SHORT\n";
  const std::string end = "ElementDataFile = LOCAL\n";
  const std::string good = start + "DimSize = 2 3 4\n" + end + std::string(48, 'a');
  EXPECT_NO_THROW(readText(dir, "good.mha", good));
  for (std::size_t cut = 0; cut < good.size(); ++cut) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.mha", good.substr(0, cut)); });
    ASSERT_NE(message, "") << cut; // names the data file where the cut leaves "ElementDataFile = L"
  }
  EXPECT_ERROR(readText(dir, "a.mha", good.substr(0, good.size() - 1)),
               "expected at least 48 bytes of samples, found 47");
  EXPECT_ERROR(readText(dir, "b.mha", start + "DimSize = 1152921504606846976 1 1\n" + end), "2^60");
  EXPECT_ERROR(readText(dir, "c.mha", start + "DimSize = 1048576 1048576 262144\n" + end), "bytes of samples, found 0");
  EXPECT_ERROR(
      readText(dir, "d.mha", start + "DimSize = 1048576 1048576 262144\nCompressedData = True\n" + end + "abc"),
      "compressed bytes cannot hold");
  EXPECT_ERROR(readText(dir, "e.mha", start + "DimSize = 2 0 4\n" + end), "2 x 0 x 4");
  EXPECT_ERROR(readText(dir, "f.mha", start + end), "DimSize");
  EXPECT_ERROR(readText(dir, "g.mha", "NDims = 99\nDimSize = 1\n" + end), "NDims");
  EXPECT_ERROR(readText(dir, "h.mha", std::string(2000, 'a') + " = b\n"), "at most 1000 characters");
  EXPECT_ERROR(readText(dir, "i.mhd", start + "DimSize = 2 3 4\nElementDataFile = s%02d.raw 1 4 1\n"), "pattern");
  EXPECT_ERROR(readText(dir, "j.mhd", start + "DimSize = 2 3 4\nElementDataFile = missing.raw\n"), "missing.raw");
  EXPECT_ERROR(readText(dir, "k.mha",
                        "NDims = 1\nDimSize = 3\nElementType = MET_FLOAT\nBinaryData = False\n" + end + "1 2 \n      "),
               "expected 3 values, found 2");
  std::string zipped(1000, '\0');
  uLongf length = zipped.size();
  const std::string noise = test::bytes(test::ramp<std::uint8_t>(48));
  compress(reinterpret_cast<Bytef*>(zipped.data()), &length, reinterpret_cast<const Bytef*>(noise.data()), 48);
  EXPECT_ERROR(readText(dir, "l.mha",
                        start + "DimSize = 2 3 4\nCompressedData = True\n" +
                            fmt::format("CompressedDataSize = {}\n", length) + end + zipped.substr(0, length / 2)),
               "l.mha");
  EXPECT_ERROR(
      readText(dir, "m.mha", "NDims = 4\nDimSize = 2 3 2 2\nElementType = MET_SHORT\n" + end + std::string(48, 'a')),
      "2 x 3 x 2 x 2");
}

// NIfTI

TEST(hbVolumeReader, NiftiLandsInLps) {
  const auto dir = test::folder();
  const auto samples = test::ramp<std::int16_t>(24, -7);
  const Nifti header(4, 16);
  for (const bool gzip : {false, true}) {
    const std::string bytes = header.bytes + test::bytes(samples);
    const hbVolume v = gzip ? readText(dir, "a.nii.gz", gzipped(bytes)) : readText(dir, "a.nii", bytes);
    EXPECT_EQ(v.type(), hbSampleType::int16);
    EXPECT_EQ(valuesOf(v), doubles(samples));
    EXPECT_EQ(v.geometry().space, "left-posterior-superior");
    // (1,2,3) in RAS: (-2 + 10, 6 + 20, 12 + 30); x and y change sign. ITK passes it through floats and a quaternion:
    // some 10 eps of a float times 42.
    EXPECT_LT(glm::length(worldOf(v.geometry(), 1, 2, 3) - glm::dvec3(-8.0, -26.0, 42.0)), 42 * 10 * 1.2e-7);
    EXPECT_LT(glm::length(v.geometry().spacing - glm::dvec3(2.0, 3.0, 4.0)), 4 * 10 * 1.2e-7);
  }
  // The same place as the same volume in RAS NRRD.
  const hbVolume nrrdVolume = readText(
      dir, "b.nrrd", nrrd("space: RAS\nspace directions: (-2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n"));
  EXPECT_LT(glm::length(worldOf(nrrdVolume.geometry(), 1, 2, 3) - glm::dvec3(-8.0, -26.0, 42.0)), 1e-13);
}

TEST(hbVolumeReader, NiftiSlopeMakesFloats) {
  Nifti header(4, 16);
  header.set<float>(112, 0.5F).set<float>(116, 10.0F);
  const hbVolume v = readText(test::folder(), "a.nii", header.bytes + test::bytes(test::ramp<std::int16_t>(24, -7)));
  EXPECT_TRUE(v.type() == hbSampleType::float32 || v.type() == hbSampleType::float64);
  EXPECT_EQ(v.value(0, 0, 0), 6.5);
  EXPECT_EQ(v.value(1, 2, 3), 18.0);
}

TEST(hbVolumeReader, NiftiDimensions) {
  const auto dir = test::folder();
  Nifti still(2, 8);
  still.dims({4, 2, 3, 4, 1, 1, 1, 1});
  EXPECT_EQ(readText(dir, "a.nii", still.bytes + std::string(24, 'a')).geometry().size, hbSize3(2, 3, 4));
  Nifti moving(2, 8);
  moving.dims({4, 2, 3, 2, 2, 1, 1, 1});
  EXPECT_ERROR(readText(dir, "b.nii", moving.bytes + std::string(24, 'a')), "2 x 3 x 2 x 2");
  Nifti flat(2, 8);
  flat.dims({2, 6, 4, 1, 1, 1, 1, 1});
  EXPECT_EQ(readText(dir, "c.nii", flat.bytes + std::string(24, 'a')).geometry().size, hbSize3(6, 4, 1));
}

TEST(hbVolumeReader, NiftiDamage) {
  const auto dir = test::folder();
  const std::string good = Nifti(2, 8).bytes + test::bytes(test::ramp<std::uint8_t>(24));
  for (std::size_t cut = 0; cut < good.size(); cut += cut < 340 ? 20 : 1) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.nii", good.substr(0, cut)); });
    ASSERT_NE(message.find("cut.nii"), std::string::npos) << cut;
  }
  EXPECT_ERROR(readText(dir, "a.nii", good.substr(0, good.size() - 1)),
               "expected at least 24 bytes of samples, found 23");
  Nifti huge(2, 8);
  huge.dims({3, 32767, 32767, 32767, 1, 1, 1, 1});
  EXPECT_ERROR(readText(dir, "b.nii", huge.bytes), "bytes of samples, found 0");
  EXPECT_ERROR(readText(dir, "b.nii.gz", gzipped(huge.bytes)), "bytes of samples, found 0");
  const std::string zipped = gzipped(good);
  EXPECT_ERROR(readText(dir, "c.nii.gz", zipped.substr(0, zipped.size() - 20)), "c.nii.gz");
  Nifti zero(2, 8);
  zero.dims({3, 2, 0, 4, 1, 1, 1, 1});
  EXPECT_ERROR(readText(dir, "d.nii", zero.bytes + std::string(24, 'a')), "d.nii");
  EXPECT_ERROR(readText(dir, "e.nii", "not at all"), "e.nii");
  const auto with = [](std::size_t at, float value) {
    return Nifti(2, 8).set<std::int16_t>(252, 1).set<float>(at, value).bytes + std::string(24, 'a');
  };
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  EXPECT_ERROR(readText(dir, "f.nii", with(284, -1.7e38F)), "byte 284: expected coordinates below 1e15");
  EXPECT_ERROR(readText(dir, "g.nii", with(256, kNaN)), "byte 256: expected coordinates");
  EXPECT_ERROR(readText(dir, "h.nii", with(80, kNaN)), "byte 80: expected coordinates");
  EXPECT_ERROR(readText(dir, "i.nii", with(108, -1.0F)), "expected samples after the header");
}

// TIFF

TEST(hbVolumeReader, Tiff) {
  const auto dir = test::folder();
  const auto samples = test::ramp<std::uint16_t>(24, 500);
  writeItk<itk::TIFFImageIO>(dir / "a.tif", {2, 3, 4}, itk::IOComponentEnum::USHORT, samples, 1, {0.5, 0.25, 1.0});
  const hbVolume v = hb::readVolume(dir / "a.tif");
  EXPECT_EQ(v.type(), hbSampleType::uint16);
  EXPECT_EQ(v.geometry().size, hbSize3(2, 3, 4));
  EXPECT_EQ(valuesOf(v), doubles(samples));
  EXPECT_EQ(v.geometry().space, "");
  // Resolutions are 32-bit floats an inch.
  EXPECT_LT(glm::length(v.geometry().spacing - glm::dvec3(0.5, 0.25, 1.0)), 1e-6);
  const auto floats = test::ramp<float>(6, -0.5F);
  writeItk<itk::TIFFImageIO>(dir / "b.TIFF", {2, 3}, itk::IOComponentEnum::FLOAT, floats);
  EXPECT_EQ(valuesOf(hb::readVolume(dir / "b.TIFF")), doubles(floats));
  EXPECT_EQ(hb::readVolume(dir / "b.TIFF").geometry().size, hbSize3(2, 3, 1));
  const auto colours = test::ramp<std::uint8_t>(36);
  writeItk<itk::TIFFImageIO>(dir / "c.tif", {2, 3, 2}, itk::IOComponentEnum::UCHAR, colours, 3);
  EXPECT_EQ(hb::readVolume(dir / "c.tif").components(), 3);
  EXPECT_EQ(valuesOf(hb::readVolume(dir / "c.tif")), doubles(colours));
}

TEST(hbVolumeReader, TiffDamage) {
  const auto dir = test::folder();
  writeItk<itk::TIFFImageIO>(dir / "a.tif", {4, 4}, itk::IOComponentEnum::UCHAR, test::ramp<std::uint8_t>(16));
  const std::string good = test::read(dir / "a.tif");
  for (std::size_t cut = 0; cut < good.size(); cut += 3) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.tif", good.substr(0, cut)); });
    ASSERT_NE(message.find("cut.tif"), std::string::npos) << cut;
  }
  EXPECT_ERROR(readText(dir, "b.tif", "not at all"), "expected a TIFF file");
  // Entries of the directory: tag, type, count, value, little-endian. The first four bytes say where it is.
  const auto patched = [&](std::uint16_t tag, std::uint32_t value) {
    std::string bytes = good;
    std::uint32_t at = 0;
    std::memcpy(&at, bytes.data() + 4, 4);
    std::uint16_t entries = 0;
    std::memcpy(&entries, bytes.data() + at, 2);
    for (std::size_t e = at + 2; e < at + 2 + 12U * entries; e += 12)
      if (std::memcmp(bytes.data() + e, &tag, 2) == 0) std::memcpy(bytes.data() + e + 8, &value, 4);
    return bytes;
  };
  EXPECT_ERROR(readText(dir, "c.tif", patched(257, 1U << 30)), "c.tif");     // length
  EXPECT_ERROR(readText(dir, "d.tif", patched(258, 32)), "32-bit integers"); // bits a sample
  EXPECT_ERROR(readText(dir, "e.tif", patched(256, 0)), "e.tif");            // width
}

// Legacy VTK

TEST(hbVolumeReader, Vtk) {
  const auto dir = test::folder();
  const auto samples = test::ramp<float>(24, 0.25F);
  const std::string start = "# vtk DataFile Version 3.0\ntitle\n";
  const std::string grid =
      "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 3 4\nSPACING 1 2 3\nORIGIN 10 20 30\nPOINT_DATA 24\n";
  const hbVolume v = readText(dir, "a.vtk",
                              start + "BINARY\n" + grid + "SCALARS Density float 1\nLOOKUP_TABLE default\n" +
                                  test::bytes(samples, true));
  EXPECT_EQ(v.type(), hbSampleType::float32);
  EXPECT_EQ(valuesOf(v), doubles(samples));
  EXPECT_EQ(v.componentNames()[0], "Density");
  EXPECT_EQ(v.geometry().spacing, glm::dvec3(1, 2, 3));
  EXPECT_EQ(v.geometry().origin, glm::dvec3(10, 20, 30));
  EXPECT_EQ(v.geometry().space, "");
  const std::string flat =
      "ASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\nSPACING 1 2 3\nORIGIN 10 20 30\nPOINT_DATA "
      "4\n";
  const hbVolume text = readText(dir, "b.vtk", start + flat + "SCALARS s short\nLOOKUP_TABLE default\n1 2\n-3 4\n");
  EXPECT_EQ(valuesOf(text), (std::vector<double>{1, 2, -3, 4}));
  EXPECT_EQ(text.geometry().spacing.z, 3.0);
  EXPECT_EQ(text.geometry().origin.z, 30.0);
  const hbVolume vectors = readText(dir, "c.vtk", start + flat + "VECTORS v double\n1 2 3 4 5 6 7 8 9 10 11 12\n");
  EXPECT_EQ(vectors.components(), 3);
  EXPECT_EQ(valuesOf(vectors), doubles(test::ramp<double>(12, 1.0)));
}

TEST(hbVolumeReader, VtkDamage) {
  const auto dir = test::folder();
  const auto file = [](const std::string& dimensions, const std::string& data, const std::string& kind = "BINARY",
                       const std::string& where = "POINT_DATA 24") {
    return "# vtk DataFile Version 3.0\ntitle\n" + kind + "\nDATASET STRUCTURED_POINTS\nDIMENSIONS " + dimensions +
           "\nSPACING 1 1 1\nORIGIN 0 0 0\n" + where + "\nSCALARS s unsigned_char 1\nLOOKUP_TABLE default\n" + data;
  };
  const std::string good = file("2 3 4", std::string(24, 'a'));
  EXPECT_NO_THROW(readText(dir, "good.vtk", good));
  for (std::size_t cut = 0; cut < good.size(); ++cut) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.vtk", good.substr(0, cut)); });
    ASSERT_NE(message.find("cut.vtk"), std::string::npos) << cut;
  }
  EXPECT_ERROR(readText(dir, "a.vtk", good.substr(0, good.size() - 1)),
               "expected at least 24 bytes of samples, found 23");
  EXPECT_ERROR(readText(dir, "b.vtk", file("1152921504606846976 1 1", "a")), "2^60");
  EXPECT_ERROR(readText(dir, "c.vtk", file("1048576 1048576 262144", "a")), "bytes of samples, found 1");
  EXPECT_ERROR(readText(dir, "d.vtk", file("4294967298 3 4", std::string(24, 'a'))), "below 2^32");
  EXPECT_ERROR(readText(dir, "e.vtk", file("2 0 4", "a")), "2 x 0 x 4");
  EXPECT_ERROR(readText(dir, "f.vtk", file("2 3", "a")), "three integers");
  EXPECT_ERROR(readText(dir, "g.vtk", file("2 3 4", std::string(24, 'a'), "BINARY", "CELL_DATA 24")), "CELL_DATA");
  EXPECT_ERROR(readText(dir, "h.vtk", file("2 1 1", "1", "ASCII")), "expected 2 values, found 1");
  EXPECT_ERROR(readText(dir, "i.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"), "STRUCTURED_POINTS");
}

// DICOM

TEST(hbVolumeReader, DicomFolder) {
  const auto dir = test::folder();
  // Out of order by name; 2.5 apart.
  writeSlice(dir / "a.dcm", 5.0, "1.2.3.4", 200);
  writeSlice(dir / "b.dcm", 0.0, "1.2.3.4", 0);
  writeSlice(dir / "c.dcm", 2.5, "1.2.3.4", 100);
  test::write(dir / "readme.txt", "no slice");
  const hbVolume v = hb::readVolume(dir);
  EXPECT_EQ(v.type(), hbSampleType::int16);
  ASSERT_EQ(v.geometry().size, hbSize3(4, 3, 3));
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) ASSERT_EQ(v.value(x, y, z), x + 4 * y + 100 * z);
  EXPECT_EQ(v.geometry().space, "left-posterior-superior");
  EXPECT_EQ(v.geometry().origin, glm::dvec3(10, 20, 0));
  EXPECT_EQ(v.geometry().spacing, glm::dvec3(0.5, 0.75, 2.5));
  EXPECT_EQ(hb::readVolume(dir / "c.dcm").value(0, 0, 0), 100.0);
}

TEST(hbVolumeReader, DicomSeriesAreToldApart) {
  const auto dir = test::folder();
  writeSlice(dir / "a.dcm", 0.0, "1.2.3.4", 0);
  writeSlice(dir / "b.dcm", 1.0, "1.2.3.4", 10);
  writeSlice(dir / "c.dcm", 0.0, "1.2.3.5", 1000);
  writeSlice(dir / "d.dcm", 1.0, "1.2.3.5", 1010);
  EXPECT_ERROR(hb::readVolume(dir), "1.2.3.4");
  EXPECT_ERROR(hb::readVolume(dir), "1.2.3.5");
  hbReadOptions options;
  options.series = "1.2.3.5";
  EXPECT_EQ(hb::readVolume(dir, options).value(0, 0, 1), 1010.0);
  options.series = "9";
  EXPECT_ERROR(hb::readVolume(dir, options), "starts with '9', found 0");
}

TEST(hbVolumeReader, DicomDamage) {
  const auto dir = test::folder();
  EXPECT_ERROR(hb::readVolume(dir), "expected a folder with DICOM slices");
  for (int i = 0; i < 5; ++i) writeSlice(dir / fmt::format("{}.dcm", i), i, "1.2.3.4", std::int16_t(i));
  EXPECT_NO_THROW(hb::readVolume(dir));
  fs::remove(dir / "2.dcm");
  EXPECT_ERROR(hb::readVolume(dir), "one missing?");
  const std::string slice = test::read(dir / "1.dcm");
  for (const std::size_t left :
       {std::size_t{0}, std::size_t{100}, std::size_t{140}, slice.size() / 2, slice.size() - 1}) {
    const std::string message = test::errorOf([&] { readText(dir, "cut.dcm", slice.substr(0, left)); });
    EXPECT_NE(message.find("cut.dcm"), std::string::npos) << left;
  }
}

// All

TEST(hbVolumeReader, MemoryLimit) {
  const auto dir = test::folder();
  hbReadOptions options;
  options.memoryLimit = 23;
  const auto packed =
      test::write(dir / "a.nrrd", "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 3 4\nencoding: gzip\n\n" +
                                      gzipped(std::string(24, 'a')));
  EXPECT_ERROR(hb::readVolume(packed, options), "needs 24 bytes of memory for its samples, the limit is 23");
  options.memoryLimit = 24;
  EXPECT_NO_THROW(hb::readVolume(packed, options));
  options.memoryLimit = 0; // what is mapped needs none
  EXPECT_NO_THROW(hb::readVolume(test::write(dir / "b.nrrd", nrrd("")), options));
}

TEST(hbVolumeReader, RawByNameOrByOption) {
  const auto dir = test::folder();
  const auto named = test::write(dir / "a_2x3x4_uint8.raw", std::string(24, 'a'));
  EXPECT_EQ(hb::readVolume(named).geometry().size, hbSize3(2, 3, 4));
  const auto other = test::write(dir / "b.raw", std::string(24, 'a'));
  EXPECT_ERROR(hb::readVolume(other), "name_256x256x128_uint16.raw");
  hbReadOptions options;
  options.raw.emplace();
  options.raw->size = {24, 1, 1};
  EXPECT_EQ(hb::readVolume(other, options).geometry().size, hbSize3(24, 1, 1));
}

TEST(hbVolumeReader, UnknownAndMissingFiles) {
  const auto dir = test::folder();
  EXPECT_ERROR(hb::readVolume(dir / "none.nrrd"), "expected a file or folder, found none");
  EXPECT_ERROR(readText(dir, "a.xyz", "text"), "expected a volume file, .nrrd, .nhdr, .mha");
  EXPECT_ERROR(hb::readVolume("/dev/null"), "a device or pipe");
}

TEST(hbVolumeReader, CanBeCancelledAndSaysHowFar) {
  const auto dir = test::folder();
  const auto path =
      test::write(dir / "a.nrrd", "NRRD0005\ntype: uint8\ndimension: 1\nsizes: 3\nencoding: gzip\n\n" + gzipped("abc"));
  struct Counter : hbProgress {
    std::int64_t last = 0, total = 0;
    void show(std::int64_t done, std::int64_t all) override { last = done, total = all; }
  } counter;
  hb::readVolume(path, {}, counter);
  EXPECT_EQ(counter.last, 3);
  EXPECT_EQ(counter.total, 3);
  hbProgress cancelled;
  cancelled.cancel();
  EXPECT_THROW(hb::readVolume(path, {}, cancelled), hbCancelled);
}

TEST(hbVolumeReader, PrintsNothing) {
  const auto dir = test::folder();
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  for (const char* name : {"a.nrrd", "a.mha", "a.nii", "a.nii.gz", "a.tif", "a.vtk", "a.dcm"})
    for (const std::string& text :
         {std::string("nonsense"), nrrd("sizes: x\n"), Nifti(2, 8).bytes, std::string("II*\0\x08\0\0\0\x05\0", 10),
          std::string("NDims = 3\nDimSize = 2 2 2\nElementType = WHAT\nElementDataFile = LOCAL\n12345678")})
      test::errorOf([&] { readText(dir, name, text); });
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}
