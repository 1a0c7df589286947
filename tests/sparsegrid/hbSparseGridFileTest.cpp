#include "sparsegrid/hbSparseGridFile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/sparsegrid/hbTestSets.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbContainerWriter.h"

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;

hbSparseGridFile readGrid(const fs::path& path, std::uint64_t memory = kMemory) {
  return hbSparseGridFile::read(hbContainerReader(path, hbSparseGridFile::chunkTypes(), memory));
}

/// A grid of level 2 over 5 x 3 samples and a flat axis.
hbSparseGridFile smallGrid() {
  const auto field = hbAnalyticField::create("multilinear")->withSize({5, 3, 1});
  const hbIndexSet set = hbIndexSet::regular(2, hbIndexSet::axesOf({5, 3, 1}));
  return {hbSparseGrid::interpolate(*field, set, hbLatticeMapping::fitted), {}, {}, {}, {}};
}

using Bytes = std::vector<std::byte>;

// Offsets in INDX.
constexpr std::size_t kBasis = 0, kFlat = 1, kReserved = 2, kCount = 4, kFirst = 8, kEntry = 8;

/// What reading says of the small grid's file with one chunk's payload changed.
std::string errorOf(const hbChunkType& type, const std::function<void(Bytes&)>& change) {
  const hbTestFolder folder;
  smallGrid().write(folder / "good.hbv");
  const hbContainerReader reader(folder / "good.hbv", hbSparseGridFile::chunkTypes(), kMemory);
  hbContainerWriter writer(folder / "bad.hbv");
  for (const hbChunkEntry& entry : reader.entries()) {
    Bytes bytes = reader.read(entry);
    if (entry.id.type == type) change(bytes);
    writer.add(entry.id, entry.kind, bytes, hbCodec::stored);
  }
  writer.commit();
  return hb::test::errorOf([&] { readGrid(folder / "bad.hbv"); });
}

void expectError(const hbChunkType& type, const std::string& words, const std::function<void(Bytes&)>& change) {
  const std::string error = errorOf(type, change);
  EXPECT_NE(error.find("bad.hbv: "), std::string::npos) << error;
  EXPECT_NE(error.find(words), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

} // namespace

RC_GTEST_PROP(hbSparseGridFile, ComesBackAsItWas, ()) {
  const hbIndexSet set = *hbTestSets::any();
  const auto components = *rc::gen::inRange<std::size_t>(1, 4);
  const auto number = rc::gen::map(rc::gen::inRange(-1000000, 1000000), [](int v) { return double(v) / 64.0; });
  std::vector<std::vector<float>> surpluses(components);
  for (auto& component : surpluses)
    component = *rc::gen::container<std::vector<float>>(
        std::size_t(set.storedValues()),
        rc::gen::map(rc::gen::arbitrary<int>(), [](int v) { return float(v) / 8.0F; }));
  hbSparseGrid::Frame frame;
  frame.geometry.size = hbTestSets::sizeOf(set);
  frame.geometry.origin = {*number, *number, *number};
  frame.geometry.spacing = {0.5, 2.0, 3.0};
  frame.geometry.space = "somewhere";
  frame.valueMap = {*number, 0.25};
  frame.mapping = *rc::gen::arbitrary<bool>() ? hbLatticeMapping::aligned : hbLatticeMapping::fitted;

  hbSparseGridFile file{hbSparseGrid::fromSurpluses(frame, set, surpluses), {}, {}, {}, {}};
  file.info.sampleType = hbSampleType::int16;
  file.info.slope = -0.5;
  file.info.intercept = *number;
  file.info.componentNames.assign(components, "a name");
  if (*rc::gen::arbitrary<bool>())
    file.range = hbRangeRecord{std::vector<hbRangeRecord::Component>(components, {-3.0, *number + 1e6})};
  if (*rc::gen::arbitrary<bool>()) file.error = hbErrorRecord{std::vector<hbErrorRecord::Component>(components)};
  file.provenance.json = R"({"source": "nowhere"})";

  const hbTestFolder folder;
  file.write(folder / "grid.hbv");
  const hbContainerReader reader(folder / "grid.hbv", hbSparseGridFile::chunkTypes(), kMemory);
  reader.verify();
  RC_ASSERT(hbSparseGridFile::isIn(reader));
  const hbSparseGridFile again = hbSparseGridFile::read(reader);
  const auto& subspaces = again.grid.indexSet().subspaces();
  RC_ASSERT(subspaces.size() == set.subspaces().size());
  for (std::size_t i = 0; i < subspaces.size(); ++i) {
    RC_ASSERT(subspaces[i].levels == set.subspaces()[i].levels);
    RC_ASSERT(subspaces[i].offset == set.subspaces()[i].offset);
    RC_ASSERT(subspaces[i].nodes == set.subspaces()[i].nodes);
  }
  RC_ASSERT(again.grid.indexSet().flat() == set.flat());
  RC_ASSERT(std::size_t(again.grid.components()) == components);
  for (std::size_t c = 0; c < components; ++c)
    RC_ASSERT(std::ranges::equal(again.grid.surpluses(int(c)), surpluses[c]));
  RC_ASSERT(again.grid.frame().geometry == frame.geometry);
  RC_ASSERT(again.grid.frame().valueMap == frame.valueMap);
  RC_ASSERT(again.grid.frame().mapping == frame.mapping);
  RC_ASSERT(again.info.sampleType == file.info.sampleType);
  RC_ASSERT(again.info.slope == file.info.slope);
  RC_ASSERT(again.info.intercept == file.info.intercept);
  RC_ASSERT(again.info.componentNames == file.info.componentNames);
  RC_ASSERT(again.range == file.range);
  RC_ASSERT(again.error == file.error);
  RC_ASSERT(again.provenance == file.provenance);
}

TEST(hbSparseGridFile, TheFramesOfGridAndInfoAreTheGrids) {
  // What the caller left in `info` does not matter where the grid knows better.
  const hbTestFolder folder;
  hbSparseGridFile file = smallGrid();
  file.info.geometry.size = {7, 7, 7};
  file.info.componentNames = {"one", "two"};
  file.write(folder / "grid.hbv");
  const hbSparseGridFile again = readGrid(folder / "grid.hbv");
  EXPECT_EQ(again.info.geometry.size, hbSize3(5, 3, 1));
  EXPECT_EQ(again.info.componentNames, std::vector<std::string>{"one"});
}

// Written by version 0.1.0 of the program; see tests/data/README.md.
TEST(hbSparseGridFile, Version10IsReadForEver) {
  const fs::path path = fs::path(HBVOL_TEST_DATA) / "sparse-1.0.hbv";
  const hbContainerReader reader(path, hbSparseGridFile::chunkTypes(), kMemory);
  reader.verify();
  const hbSparseGridFile file = hbSparseGridFile::read(reader);
  EXPECT_EQ(file.grid.geometry().size, hbSize3(5, 3, 1));
  EXPECT_EQ(file.grid.frame().mapping, hbLatticeMapping::aligned);
  EXPECT_EQ(file.info.sampleType, hbSampleType::float32);
  EXPECT_EQ(file.grid.components(), 1);
  EXPECT_EQ(file.grid.indexSet().storedValues(), 15);
  EXPECT_EQ(file.grid.indexSet().subspaces().size(), 6U);
  EXPECT_EQ(file.grid.indexSet().flat(), glm::bvec3(false, false, true));
  for (const double x : {0.0, 0.25, 0.3, 1.0})
    for (const double y : {0.0, 0.5, 0.9, 1.0}) {
      // 1 + 2x + 3y - 4z + 5xy - 6yz + 7xz + 8xyz in the middle of z; surpluses below 8 rounded to floats, 15 of them.
      EXPECT_NEAR(file.grid.calcValue({x, y, 0.5}, 0), -1 + 5.5 * x + 9 * x * y, 15 * 4 * 0x1p-24);
    }
  ASSERT_TRUE(file.range);
  EXPECT_EQ(file.range->components.at(0), (hbRangeRecord::Component{-1.0, 13.5}));
  ASSERT_TRUE(file.error);
  EXPECT_EQ(file.error->components.at(0).points, 15U);
  EXPECT_EQ(file.error->components.at(0).max, 0.0);
  EXPECT_NE(file.provenance.json.find("multilinear-5x3x1.nrrd"), std::string::npos);
}

TEST(hbSparseGridFile, IndexSetsAreBytesAsDocumented) {
  // doc/formats.md: basis, flat axes, reserved, count; then levels, reserved, quantiser step.
  const hbIndexSet set = hbIndexSet::regular(1, {{1, 0, 0}, {false, false, true}});
  const std::vector<std::byte> bytes = hb::encodeIndexSet(set);
  const std::vector<int> expected{0, 4, 0, 0, 2, 0, 0, 0, //
                                  0, 0, 0, 0, 0, 0, 0, 0, //
                                  1, 0, 0, 0, 0, 0, 0, 0};
  ASSERT_EQ(bytes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(std::to_integer<int>(bytes[i]), expected[i]) << i;
}

TEST(hbSparseGridFile, RefusesWrongIndexSets) {
  const hbChunkType type = hbSparseGridFile::kIndexSet;
  expectError(type, "basis 1", [](Bytes& b) { b[kBasis] = std::byte{1}; });
  expectError(type, "flat axes as three bits, found 8", [](Bytes& b) { b[kFlat] = std::byte{8}; });
  expectError(type, "zero", [](Bytes& b) { b[kReserved] = std::byte{1}; });
  expectError(type, "zero", [](Bytes& b) { b[kFirst + 3] = std::byte{1}; });
  expectError(type, "subspaces of 8 bytes", [](Bytes& b) { b[kCount] = std::byte{200}; });
  expectError(type, "subspaces of 8 bytes", [](Bytes& b) { std::memset(b.data() + kCount, 0xFF, 4); });
  expectError(type, "subspaces of 8 bytes", [](Bytes& b) { b.insert(b.end(), kEntry, std::byte{0}); });
  expectError(type, "more bytes", [](Bytes& b) { b = Bytes(3); });
  expectError(type, "at least one subspace", [](Bytes& b) { b = Bytes(kFirst); });
  expectError(type, "not quantised", [](Bytes& b) { hb::test::poke(b, kFirst + 4, 0.5F); });
  expectError(type, "not quantised",
              [](Bytes& b) { hb::test::poke(b, kFirst + 4, std::numeric_limits<float>::quiet_NaN()); });
  expectError(type, "levels from 0 to 20 along x", [](Bytes& b) { b[kFirst] = std::byte{21}; });
  expectError(type, "levels from 0 to 0 along z", [](Bytes& b) { b[kFirst + 2] = std::byte{1}; });
  expectError(type, "each subspace once",
              [](Bytes& b) { std::memcpy(b.data() + kFirst + kEntry, b.data() + kFirst, 3); });
  expectError(type, "beside", [](Bytes& b) { b[b.size() - kEntry] = std::byte{7}; });
  expectError(type, "ordered", [](Bytes& b) {
    std::swap_ranges(b.begin() + kFirst, b.begin() + kFirst + kEntry, b.begin() + kFirst + kEntry);
  });
}

TEST(hbSparseGridFile, CountsBeyondAllMemoryAreNoticedBeforeAllocating) {
  // Every index up to level 20 on three axes: (2^20 + 1)^3 values.
  const auto everything = [](int finest) {
    return [finest](Bytes& b) { b = hb::encodeIndexSet(hbIndexSet::full({glm::ivec3(finest), glm::bvec3(false)})); };
  };
  expectError(hbSparseGridFile::kIndexSet, "2199828660228 bytes",
              everything(13)); // 4 (2^13 + 1)^3: more than the payload
  expectError(hbSparseGridFile::kIndexSet, "fewer than 2^60 values", [](Bytes& b) {
    // Written out here, for there is no such set to encode; its order does not come to matter.
    Bytes bytes(kFirst);
    std::uint32_t count = 0;
    for (int z = 0; z <= 20; ++z)
      for (int y = 0; y <= 20; ++y)
        for (int x = 0; x <= 20; ++x, ++count) {
          const std::array<std::byte, kEntry> entry{std::byte(x), std::byte(y), std::byte(z)};
          bytes.insert(bytes.end(), entry.begin(), entry.end());
        }
    std::memcpy(bytes.data() + kCount, &count, sizeof(count));
    b = bytes;
  });
}

TEST(hbSparseGridFile, RefusesWrongSurpluses) {
  const hbChunkType type = hbSparseGridFile::kSurpluses;
  expectError(type, "for the index set's", [](Bytes& b) { b.erase(b.end() - 4, b.end()); });
  expectError(type, "for the index set's", [](Bytes& b) { b.push_back(std::byte{0}); });
  expectError(type, "finite", [](Bytes& b) { hb::test::poke(b, 8, std::numeric_limits<float>::quiet_NaN()); });
  expectError(type, "finite", [](Bytes& b) { hb::test::poke(b, 0, -std::numeric_limits<float>::infinity()); });
  // Flat where the geometry is not: another index set, sizes aside.
  expectError(hbDatasetInfo::kType, "sparse grid", [](Bytes& b) { hb::test::poke(b, 16, std::int64_t{2}); });
}

TEST(hbSparseGridFile, RefusesMissingChunks) {
  const hbTestFolder folder;
  smallGrid().write(folder / "good.hbv");
  const hbContainerReader reader(folder / "good.hbv", hbSparseGridFile::chunkTypes(), kMemory);
  for (const hbChunkType& type : {hbDatasetInfo::kType, hbSparseGridFile::kIndexSet, hbSparseGridFile::kSurpluses}) {
    hbContainerWriter writer(folder / "less.hbv");
    for (const hbChunkEntry& entry : reader.entries())
      if (entry.id.type != type) writer.add(entry.id, entry.kind, reader.read(entry), hbCodec::zstd);
    writer.commit();
    EXPECT_HB_ERROR(readGrid(folder / "less.hbv"), type.text());
    const hbContainerReader less(folder / "less.hbv", hbSparseGridFile::chunkTypes(), kMemory);
    EXPECT_EQ(hbSparseGridFile::isIn(less), type != hbSparseGridFile::kIndexSet);
  }
}

TEST(hbSparseGridFile, MayNotTakeMoreMemoryThanAllowed) {
  const hbTestFolder folder;
  const auto field = hbAnalyticField::create("smooth");
  hbSparseGridFile{
      hbSparseGrid::interpolate(*field, hbIndexSet::regular(6, {}), hbLatticeMapping::fitted), {}, {}, {}, {}}
      .write(folder / "grid.hbv");
  EXPECT_HB_ERROR(readGrid(folder / "grid.hbv", 4096), "memory limit");
  EXPECT_NO_THROW(readGrid(folder / "grid.hbv", 2 * 4 * 3713)); // the surpluses, and they once more while unpacked
}

TEST(hbSparseGridFile, FailedWritesLeaveTheOldFile) {
  const hbTestFolder folder;
  hb::test::writeFile(folder / "old.hbv", hb::test::bytesOf("old"));
  hbSparseGridFile file = smallGrid();
  file.provenance.json = "no JSON";
  EXPECT_HB_ERROR(file.write(folder / "old.hbv"), "provenance");
  EXPECT_HB_ERROR(smallGrid().write(folder / "none" / "x.hbv"), "cannot be written");
  EXPECT_EQ(hb::test::readFile(folder / "old.hbv"), hb::test::bytesOf("old"));
  EXPECT_EQ(folder.files(), 1);
}
