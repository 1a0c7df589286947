// What becomes of an .hbv file that was cut, changed or lengthened.

#include <random>

#include "sparsegrid/hbSparseGridFile.h"
#include "tests/apps/hbAppTest.h"
#include "volume/hbContainerReader.h"
#include "volume/hbContainerWriter.h"

namespace {

constexpr std::uint64_t kMemory = std::uint64_t{1} << 24;

/// What the program does with a file, without the program: the error, or "no error" where all of it is right.
std::string errorOfReading(const std::filesystem::path& path) {
  return hb::test::errorOf([&] {
    const hbContainerReader reader(path, hbSparseGridFile::chunkTypes(), kMemory);
    hbSparseGridFile::read(reader);
    reader.verify();
  });
}

} // namespace

class damagedFile : public hbAppTest {
protected:
  std::vector<std::byte> good_;

  void SetUp() override {
    EXPECT_RUNS(run({"compress", "field:smooth", "good.hbv", "--level", "2"}));
    good_ = bytes("good.hbv");
    ASSERT_EQ(errorOfReading(folder_ / "good.hbv"), "no error");
  }

  void writeBytes(const std::string& name, const std::vector<std::byte>& bytes) const {
    hb::test::writeFile(folder_ / name, bytes);
  }
};

TEST_F(damagedFile, AnyTruncationIsNoticed) {
  for (std::size_t size = 0; size < good_.size(); ++size) {
    writeBytes("cut.hbv", {good_.begin(), good_.begin() + std::ptrdiff_t(size)});
    const std::string error = errorOfReading(folder_ / "cut.hbv");
    ASSERT_NE(error, "no error") << size;
    ASSERT_EQ(error.find('\n'), std::string::npos) << error;
  }
  for (std::size_t size = 0; size < good_.size(); size += good_.size() / 16) {
    writeBytes("cut.hbv", {good_.begin(), good_.begin() + std::ptrdiff_t(size)});
    expectFailureLeavesAll({"render", "cut.hbv", "x.exr", "--size", "4x4"}, 1, "cut.hbv");
  }
}

TEST_F(damagedFile, AnyChangedByteIsNoticed) {
  std::mt19937 random(7);
  for (std::size_t at = 0; at < good_.size(); ++at) {
    std::vector<std::byte> changed = good_;
    changed[at] ^= std::byte(1 + random() % 255);
    writeBytes("changed.hbv", changed);
    ASSERT_NE(errorOfReading(folder_ / "changed.hbv"), "no error") << at;
  }
  // Through the program: either an error or, where verify() alone looks, the right outcome.
  EXPECT_RUNS(run({"extract", "good.hbv", "good.nrrd"}));
  const std::size_t step = good_.size() / 64;
  for (std::size_t at = random() % step; at < good_.size(); at += step) {
    std::vector<std::byte> changed = good_;
    changed[at] ^= std::byte(1 + random() % 255);
    writeBytes("changed.hbv", changed);
    EXPECT_FAILS(run({"info", "changed.hbv", "--verify"}), 1, "changed.hbv");
    if (at % 4 != 0) continue;
    const hbProgramRun extracted = run({"extract", "changed.hbv", "changed.nrrd"});
    if (extracted.exitCode == 0)
      EXPECT_EQ(bytes("changed.nrrd"), bytes("good.nrrd")) << at;
    else
      EXPECT_FAILS(extracted, 1, "changed.hbv");
  }
}

TEST_F(damagedFile, AnythingAddedIsNoticed) {
  for (const std::size_t more : {1, 64, 4096}) {
    std::vector<std::byte> longer = good_;
    longer.resize(longer.size() + more);
    writeBytes("longer.hbv", longer);
    expectFailureLeavesAll({"info", "longer.hbv"}, 1, "something was added");
  }
}

TEST_F(damagedFile, HostileProvenanceIsShownOrRefused) {
  // Well-formed in every way, and as deep as a megabyte can be.
  constexpr std::size_t kDepth = 500000;
  const hbContainerReader reader(folder_ / "good.hbv", hbSparseGridFile::chunkTypes(), kMemory);
  hbContainerWriter writer(folder_ / "deep.hbv");
  for (const hbChunkEntry& entry : reader.entries())
    if (entry.id.type != hbProvenance::kType) writer.add(entry.id, entry.kind, reader.read(entry), hbCodec::stored);
  writer.add({hbProvenance::kType}, hbProvenance::kKind,
             hb::test::bytesOf(std::string(kDepth, '[') + std::string(kDepth, ']')), hbCodec::zstd);
  writer.commit();
  for (const char* flag : {"--json", "--verify"}) {
    const hbProgramRun shown = run({"info", "deep.hbv", flag});
    if (shown.exitCode != 0) EXPECT_FAILS(shown, 1, "deep.hbv");
  }
}
