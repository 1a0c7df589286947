// The file of format version 1.0 that every later reader must read: see tests/data/README.md.

#include <cstdlib>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbContainerReader.h"
#include "volume/hbContainerWriter.h"
#include "volume/hbDatasetInfo.h"
#include "volume/hbErrorRecord.h"
#include "volume/hbProvenance.h"
#include "volume/hbRangeRecord.h"

namespace {

namespace fs = std::filesystem;

const std::vector<hbChunkType> kKnown{hbDatasetInfo::kType, hbErrorRecord::kType, hbRangeRecord::kType,
                                      hbProvenance::kType, "TEST"};
constexpr std::uint64_t kMemory = 65536;

hbDatasetInfo goldenInfo() {
  hbDatasetInfo info;
  info.geometry.size = {5, 3, 2};
  info.geometry.origin = {-1.5, 2.25, 1000.0};
  info.geometry.spacing = {0.5, 0.25, 2.0};
  info.geometry.direction = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
  info.geometry.centring = hbGeometry::Centring::cell;
  info.geometry.space = "left-posterior-superior";
  info.sampleType = hbSampleType::uint16;
  info.slope = 0.5;
  info.intercept = -1024.0;
  info.valueMap = {3.0, 2.0};
  info.mapping = hbLatticeMapping::aligned;
  info.componentNames = {"density", ""};
  return info;
}

hbErrorRecord goldenErrors() {
  return {{{hbErrorRecord::Reference::allSamples, hbErrorRecord::Kind::measured, 30, 0.75, 0.25, 48.5},
           {hbErrorRecord::Reference::analyticField, hbErrorRecord::Kind::guaranteed, 100, 0.0, 0.0,
            std::numeric_limits<double>::infinity()}}};
}

hbRangeRecord goldenRange() { return {{{-1024.0, 3071.5}, {-0.125, 0.125}}}; }

hbProvenance goldenProvenance() { return {R"({"made by": "hbContainerGolden"})"}; }

/// 250 floats, all of them exact, and three bytes more.
std::vector<std::byte> goldenArray() {
  std::vector<float> values(250);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i * i) / 64.0F - 100.0F;
  std::vector<std::byte> bytes(values.size() * sizeof(float) + 3);
  std::memcpy(bytes.data(), values.data(), values.size() * sizeof(float));
  for (std::size_t i = 0; i < 3; ++i) bytes[bytes.size() - 3 + i] = std::byte(i + 1);
  return bytes;
}

void writeGolden(const fs::path& path) {
  {
    hbContainerWriter writer(path);
    writer.add({hbDatasetInfo::kType}, hbDatasetInfo::kKind, goldenInfo().encode(), hbCodec::stored);
    writer.add({hbProvenance::kType}, hbProvenance::kKind, goldenProvenance().encode(), hbCodec::zstd);
    writer.add({"TEST", 1, 2, 3, 0xFEDCBA9876543210U}, hbChunkKind::critical, goldenArray(), hbCodec::planesZstd);
    writer.add({"TEST", 0, 0, 0, 1}, hbChunkKind::critical, goldenArray(), hbCodec::zstd);
    writer.commit();
  }
  hbContainerWriter writer = hbContainerWriter::appendTo(path, kKnown);
  writer.add({hbErrorRecord::kType}, hbErrorRecord::kKind, goldenErrors().encode(), hbCodec::stored);
  writer.add({hbRangeRecord::kType}, hbRangeRecord::kKind, goldenRange().encode(), hbCodec::stored);
  writer.add({"what"}, hbChunkKind::ancillary, {}, hbCodec::stored);
  writer.commit();
}

} // namespace

TEST(hbContainerGolden, Version10IsReadForEver) {
  const hbContainerReader reader(fs::path(HBVOL_TEST_DATA) / "container-1.0.hbv", kKnown, kMemory);
  reader.verify();
  EXPECT_EQ(reader.header().minor, 0);
  EXPECT_EQ(reader.header().features, 0U);
  ASSERT_EQ(reader.entries().size(), 7U);
  const auto payload = [&](const hbChunkId& id) {
    const hbChunkEntry* entry = reader.find(id);
    EXPECT_NE(entry, nullptr) << hb::describe(id);
    return entry == nullptr ? std::vector<std::byte>() : reader.read(*entry);
  };
  EXPECT_EQ(hbDatasetInfo::decode(payload({hbDatasetInfo::kType}), "GEOM"), goldenInfo());
  EXPECT_EQ(hbErrorRecord::decode(payload({hbErrorRecord::kType}), "ERRS"), goldenErrors());
  EXPECT_EQ(hbRangeRecord::decode(payload({hbRangeRecord::kType}), "RNGE"), goldenRange());
  EXPECT_EQ(hbProvenance::decode(payload({hbProvenance::kType}), "PROV"), goldenProvenance());
  EXPECT_EQ(payload({"TEST", 1, 2, 3, 0xFEDCBA9876543210U}), goldenArray());
  EXPECT_EQ(payload({"TEST", 0, 0, 0, 1}), goldenArray());
  EXPECT_EQ(payload({"what"}).size(), 0U);
  // One chunk of each codec, or the file would not show that all of them are still read.
  EXPECT_EQ(reader.entries()[0].codec, hbCodec::stored);
  EXPECT_EQ(reader.find({"TEST", 1, 2, 3, 0xFEDCBA9876543210U})->codec, hbCodec::planesZstd);
  EXPECT_EQ(reader.find({"TEST", 0, 0, 0, 1})->codec, hbCodec::zstd);
  EXPECT_EQ(reader.find({hbDatasetInfo::kType})->kind, hbChunkKind::critical);
  EXPECT_EQ(reader.find({hbErrorRecord::kType})->kind, hbChunkKind::ancillary);
}

TEST(hbContainerGolden, TheWriterStillMakesTheSameContent) {
  // Not the same bytes: those of zstd change with its version. HBVOL_KEEP_GOLDEN=<path> keeps the file.
  const hbTestFolder folder;
  const char* keep = std::getenv("HBVOL_KEEP_GOLDEN");
  const fs::path made = keep != nullptr ? fs::path(keep) : folder / "made.hbv";
  writeGolden(made);
  const hbContainerReader golden(fs::path(HBVOL_TEST_DATA) / "container-1.0.hbv", kKnown, kMemory);
  const hbContainerReader now(made, kKnown, kMemory);
  ASSERT_EQ(now.entries().size(), golden.entries().size());
  for (std::size_t i = 0; i < now.entries().size(); ++i) {
    EXPECT_EQ(now.entries()[i].id, golden.entries()[i].id);
    EXPECT_EQ(now.entries()[i].kind, golden.entries()[i].kind);
    EXPECT_EQ(now.read(now.entries()[i]), golden.read(golden.entries()[i]));
  }
}
