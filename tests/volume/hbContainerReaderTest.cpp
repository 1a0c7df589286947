#include "volume/hbContainerReader.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbContainerWriter.h"

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t kHeader = 64, kEntry = 80;

/// A small file with chunks of each codec, of sizes with and without padding, and an empty one.
std::vector<std::byte> smallFile(const hbTestFolder& folder) {
  hbContainerWriter writer(folder / "small.hbv");
  writer.add({"CRIT"}, hbChunkKind::critical, hb::test::bytesOf("not shorter"), hbCodec::zstd);
  writer.add({"ANCI", 1, 2, 3, 4}, hbChunkKind::ancillary, std::vector<std::byte>(64, std::byte{5}), hbCodec::stored);
  writer.add({"NONE"}, hbChunkKind::ancillary, {}, hbCodec::stored);
  writer.add({"ZSTD"}, hbChunkKind::critical, std::vector<std::byte>(1000, std::byte{6}), hbCodec::zstd);
  writer.add({"PLAN"}, hbChunkKind::critical, std::vector<std::byte>(1001, std::byte{7}), hbCodec::planesZstd);
  writer.commit();
  return hb::test::readFile(folder / "small.hbv");
}

constexpr std::size_t kZstdEntry = 3; // of smallFile's table

const std::vector<hbChunkType> kKnown{"CRIT", "ANCI", "NONE", "ZSTD", "PLAN"};

std::uint64_t tableOffset(const std::vector<std::byte>& file) {
  std::uint64_t offset = 0;
  std::memcpy(&offset, file.data() + 32, sizeof(offset));
  return offset;
}

/// Makes the checksums of table (where its offset is within the file) and header right again.
void reseal(std::vector<std::byte>& file) {
  if (const std::uint64_t table = tableOffset(file); table <= file.size())
    hb::test::poke(file, 48, hb::checksum(std::span(file).subspan(table)));
  hb::test::poke(file, 56, hb::checksum(std::span(file).first(56)));
}

/// Opens the changed file and reads all of it; the error's text, which is that of the same bytes in memory.
std::string errorOfFile(const hbTestFolder& folder, std::span<const std::byte> file,
                        const std::vector<hbChunkType>& known = kKnown, std::uint64_t limit = kNoLimit) {
  hb::test::writeFile(folder / "changed.hbv", file);
  const std::string name = (folder / "changed.hbv").string();
  const std::string error = hb::test::errorOf([&] { hbContainerReader(name, known, limit).verify(); });
  EXPECT_EQ(hb::test::errorOf([&] { hbContainerReader(file, name, known, limit).verify(); }), error);
  return error;
}

#define EXPECT_FILE_ERROR(file, text)                                                                                  \
  do {                                                                                                                 \
    const std::string found = errorOfFile(folder, file);                                                               \
    EXPECT_NE(found.find(text), std::string::npos) << "found: " << found;                                              \
  } while (false)

} // namespace

TEST(hbContainerReader, ReadsChunksById) {
  const hbTestFolder folder;
  smallFile(folder);
  const hbContainerReader reader(folder / "small.hbv", kKnown, 1001);
  EXPECT_EQ(reader.entries().size(), 5U);
  const hbChunkEntry* entry = reader.find({"ANCI", 1, 2, 3, 4});
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->kind, hbChunkKind::ancillary);
  EXPECT_EQ(reader.read(*entry), std::vector<std::byte>(64, std::byte{5}));
  EXPECT_EQ(reader.find({"ANCI", 1, 2, 3, 5}), nullptr);
  EXPECT_EQ(reader.find({"ANCI"}), nullptr);
  EXPECT_EQ(reader.read(*reader.find({"PLAN"})), std::vector<std::byte>(1001, std::byte{7}));
  EXPECT_NO_THROW(reader.verify());
}

TEST(hbContainerReader, FindsEveryFlippedBit) {
  const hbTestFolder folder;
  auto file = smallFile(folder);
  ASSERT_LT(file.size(), 1500U); // or this test takes long
  ASSERT_EQ(errorOfFile(folder, file), "no error");
  for (std::size_t at = 0; at < file.size(); ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      file[at] ^= std::byte(1U << bit);
      ASSERT_NE(errorOfFile(folder, file), "no error") << "byte " << at << " bit " << bit;
      file[at] ^= std::byte(1U << bit);
    }
}

TEST(hbContainerReader, FindsEveryTruncation) {
  const hbTestFolder folder;
  const auto file = smallFile(folder);
  for (std::size_t size = 0; size < file.size(); ++size) {
    hb::test::writeFile(folder / "changed.hbv", std::span(file).first(size));
    ASSERT_THROW(hbContainerReader(folder / "changed.hbv", kKnown, kNoLimit), hbError) << size << " bytes";
  }
  EXPECT_FILE_ERROR(std::span(file).first(0), "changed.hbv: expected an .hbv file, found an empty one");
  EXPECT_FILE_ERROR(std::span(file).first(5),
                    "expected an .hbv file (magic 89 48 42 56 0D 0A 1A 0A), found 89 48 42 56");
  EXPECT_FILE_ERROR(std::span(file).first(63), "expected a header of 64 bytes, found a file of 63: truncated");
  EXPECT_FILE_ERROR(std::span(file).first(file.size() - 1), ": truncated");
}

TEST(hbContainerReader, RefusesAFileThatIsTooLong) {
  const hbTestFolder folder;
  for (const std::size_t more : {1U, 64U, 80U}) {
    auto file = smallFile(folder);
    file.resize(file.size() + more);
    EXPECT_FILE_ERROR(file, "something was added");
  }
}

TEST(hbContainerReader, TellsFilesOfAnotherKind) {
  const hbTestFolder folder;
  EXPECT_HB_ERROR(hbContainerReader(folder / "none.hbv", {}, kNoLimit), "none.hbv: cannot be read: No such file");
  EXPECT_HB_ERROR(hbContainerReader(folder.path(), {}, kNoLimit), ": expected an .hbv file, found a folder");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_HB_ERROR(hbContainerReader(folder / "pipe", {}, kNoLimit), ": expected an .hbv file, found a device or pipe");
  EXPECT_FILE_ERROR(
      hb::test::bytesOf("NRRD0004\ntype: float\n"),
      "changed.hbv: expected an .hbv file (magic 89 48 42 56 0D 0A 1A 0A), found 4E 52 52 44 30 30 30 34");
  EXPECT_EQ(errorOfFile(folder, hb::test::bytesOf("NRRD0004\n")).find("text mode"), std::string::npos);
}

TEST(hbContainerReader, TellsDamageByATransferInTextMode) {
  const hbTestFolder folder;
  const auto file = smallFile(folder);
  const std::string_view rest(reinterpret_cast<const char*>(file.data()) + 8, file.size() - 8);
  for (const std::string_view magic : {
           std::string_view("\x89HBV\n\x1A\n"),           // CR LF became LF
           std::string_view("\x89HBV\r\r\n\x1A\r\n"),     // LF became CR LF
           std::string_view("\x09HBV\r\n\x1A\n"),         // seven bits
           std::string_view("\xC2\x89HBV\r\n\x1A\n"),     // Latin-1 became UTF-8
           std::string_view("\xEF\xBF\xBDHBV\r\n\x1A\n"), // what is not UTF-8 was replaced
       })
    EXPECT_FILE_ERROR(hb::test::bytesOf(std::string(magic) + std::string(rest)),
                      "damaged, as by a transfer in text mode");
}

TEST(hbContainerReader, RefusesAnotherMajorVersionAndAcceptsANewerMinorOne) {
  const hbTestFolder folder;
  auto file = smallFile(folder);
  hb::test::poke(file, 8, std::uint16_t{2});
  hb::test::poke(file, 10, std::uint16_t{7});
  EXPECT_FILE_ERROR(file, "expected format version 1.x, found 2.7: written by a newer program"); // checksum or not
  reseal(file);
  EXPECT_FILE_ERROR(file, "expected format version 1.x, found 2.7: written by a newer program");
  hb::test::poke(file, 8, std::uint16_t{0});
  reseal(file);
  EXPECT_FILE_ERROR(file, "expected format version 1.x, found 0.7");
  hb::test::poke(file, 8, std::uint16_t{1});
  reseal(file);
  EXPECT_EQ(errorOfFile(folder, file), "no error");

  // And appending keeps the newer number, as chunks of that version may be among the old ones.
  hbContainerWriter writer = hbContainerWriter::appendTo(folder / "changed.hbv", kKnown);
  writer.commit();
  EXPECT_EQ(hbContainerReader(folder / "changed.hbv", kKnown, kNoLimit).header().minor, 7);
}

TEST(hbContainerReader, RefusesUnknownFeatures) {
  const hbTestFolder folder;
  for (const int bit : {0, 5, 63}) {
    auto file = smallFile(folder);
    hb::test::poke(file, 16, std::uint64_t{1} << bit);
    reseal(file);
    EXPECT_FILE_ERROR(file, "found feature bit " + std::to_string(bit));
  }
}

TEST(hbContainerReader, SkipsUnknownAncillaryChunksAndRefusesUnknownCriticalOnes) {
  const hbTestFolder folder;
  auto file = smallFile(folder);
  EXPECT_EQ(errorOfFile(folder, file, {"CRIT", "ZSTD", "PLAN"}), "no error");
  EXPECT_NE(
      errorOfFile(folder, file, {"CRIT", "PLAN"}).find("chunk ZSTD (dataset 0, step 0, component 0, key 0): needed"),
      std::string::npos);
  // An ancillary chunk of unknown type may have an unknown codec; its bytes are verified all the same.
  const std::size_t entry = tableOffset(file) + kZstdEntry * kEntry;
  hb::test::poke(file, entry + 4, std::uint32_t{0});
  hb::test::poke(file, entry + 56, std::uint16_t{9});
  reseal(file);
  EXPECT_EQ(errorOfFile(folder, file, {"CRIT", "PLAN"}), "no error");
  EXPECT_FILE_ERROR(file, "expected a codec from 0 to 2 in version 1, found codec 9 in version 1");
  file[kHeader + 128] ^= std::byte{1}; // in the chunk ZSTD, which is the third with bytes
  EXPECT_NE(errorOfFile(folder, file, {"CRIT", "PLAN"}).find("chunk ZSTD"), std::string::npos);
}

TEST(hbContainerReader, RefusesHeadersWhoseSizesCannotBe) {
  const hbTestFolder folder;
  const auto good = smallFile(folder);
  const auto with = [&](std::size_t at, std::uint64_t value) {
    auto file = good;
    hb::test::poke(file, at, value);
    reseal(file);
    return file;
  };
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 60U;
  EXPECT_FILE_ERROR(with(24, kHuge), "as its header says, found"); // total size
  EXPECT_FILE_ERROR(with(24, 0), "as its header says, found");
  for (const std::uint64_t offset : {kHuge, std::uint64_t{0}, tableOffset(good) + 1, kNoLimit, kNoLimit - 63})
    EXPECT_FILE_ERROR(with(32, offset), "expected the table at a multiple of 64 from 64 to");
  EXPECT_FILE_ERROR(with(32, kHeader), "expected a table of 5 entries of 80 bytes at the end");
  // Entry counts: too many, and one whose table would take 2^64 + 400 bytes, which wrap around to the right size.
  for (const std::uint64_t count : {kHuge, std::uint64_t{6}, std::uint64_t{4}, std::uint64_t{0}, kHuge + 5})
    EXPECT_FILE_ERROR(with(40, count), "entries of 80 bytes at the end, found 400 bytes");
  auto file = good;
  hb::test::poke(file, 12, std::uint32_t{128});
  reseal(file);
  EXPECT_FILE_ERROR(file, "expected a header of 64 bytes, found 128");
}

TEST(hbContainerReader, RefusesTableEntriesThatCannotBe) {
  const hbTestFolder folder;
  const auto good = smallFile(folder);
  const auto with = [&](std::size_t entry, std::size_t at, auto value) {
    auto file = good;
    hb::test::poke(file, tableOffset(good) + entry * kEntry + at, value);
    reseal(file);
    return file;
  };
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 60U;
  EXPECT_FILE_ERROR(with(0, 0, '\n'), "expected a type of four ASCII characters, found 0A 52 49 54");
  EXPECT_FILE_ERROR(with(0, 4, std::uint32_t{3}),
                    "chunk CRIT (dataset 0, step 0, component 0, key 0): expected flags 0 or 1");
  EXPECT_FILE_ERROR(with(0, 20, std::uint32_t{1}), "expected a zero byte at offset 20, found 1");
  EXPECT_FILE_ERROR(with(0, 60, std::uint32_t{256}), "expected a zero byte at offset 61, found 1");
  // Offsets: in the header, overlapping the chunk before, leaving a gap, beyond the file.
  EXPECT_FILE_ERROR(with(0, 32, std::uint64_t{0}), "expected to begin at offset 64");
  for (const std::uint64_t offset : {std::uint64_t{64}, std::uint64_t{192}, std::uint64_t{129}, kHuge, kNoLimit})
    EXPECT_FILE_ERROR(with(1, 32, offset), "key 4): expected to begin at offset 128, where the one before ends, found");
  // Stored sizes: reaching into the next chunk, beyond the table, wrapping around.
  auto overlapping = with(1, 40, std::uint64_t{65});
  hb::test::poke(overlapping, tableOffset(good) + kEntry + 48, std::uint64_t{65});
  reseal(overlapping);
  EXPECT_FILE_ERROR(overlapping, "chunk NONE (dataset 0, step 0, component 0, key 0): expected to begin at offset 256");
  for (const std::uint64_t size : {kHuge, kNoLimit, kNoLimit - 127})
    EXPECT_FILE_ERROR(with(1, 40, size), "bytes before the table, found");
  EXPECT_FILE_ERROR(with(4, 40, std::uint64_t{1}), "expected"); // PLAN one byte long
  // Raw sizes that do not fit the codec.
  EXPECT_FILE_ERROR(with(1, 48, kHuge), "in the file, found 64");
  EXPECT_FILE_ERROR(with(kZstdEntry, 48, std::uint64_t{1}), "expected fewer than 1 bytes in the file, found");
  // The last chunk must reach the table: without it there would be bytes that no checksum covers.
  auto file = good;
  file.resize(file.size() - kEntry);
  hb::test::poke(file, 24, std::uint64_t{file.size()});
  hb::test::poke(file, 40, std::uint64_t{4});
  reseal(file);
  EXPECT_FILE_ERROR(file, "expected the table at offset");
  // An id twice.
  EXPECT_FILE_ERROR(with(4, 0, std::array{'Z', 'S', 'T', 'D'}),
                    "chunk ZSTD (dataset 0, step 0, component 0, key 0): expected once, found twice");
}

TEST(hbContainerReader, RefusesStreamsThatLieAboutTheirSize) {
  const hbTestFolder folder;
  for (const std::size_t chunk : {kZstdEntry, kZstdEntry + 1})
    for (const int lie : {-1, 1}) {
      auto file = smallFile(folder);
      const std::uint64_t claimed = std::uint64_t(int(1000 + (chunk - kZstdEntry)) + lie);
      hb::test::poke(file, tableOffset(file) + chunk * kEntry + 48, claimed);
      reseal(file);
      EXPECT_FILE_ERROR(file, "bytes when unpacked, found");
    }
  // The right size, but not the bytes that were packed.
  auto file = smallFile(folder);
  hb::test::poke(file, tableOffset(file) + kZstdEntry * kEntry + 72, std::uint64_t{1});
  reseal(file);
  EXPECT_FILE_ERROR(
      file, "chunk ZSTD (dataset 0, step 0, component 0, key 0): expected checksum 0000000000000001 when unpacked");
}

TEST(hbContainerReader, KeepsToTheMemoryLimit) {
  const hbTestFolder folder;
  auto file = smallFile(folder);
  EXPECT_EQ(errorOfFile(folder, file, kKnown, 1001), "no error");
  EXPECT_NE(errorOfFile(folder, file, kKnown, 1000)
                .find("chunk PLAN (dataset 0, step 0, component 0, key 0): expected at "
                      "most 1000 bytes of memory to be needed, found 1001"),
            std::string::npos);
  EXPECT_NE(errorOfFile(folder, file, kKnown, 399).find("table: expected at most 399 bytes of memory"),
            std::string::npos);
  hb::test::poke(file, tableOffset(file) + kZstdEntry * kEntry + 48, std::uint64_t{1} << 60U);
  reseal(file);
  EXPECT_NE(errorOfFile(folder, file, kKnown, std::uint64_t{1} << 30U).find("found 1152921504606846976"),
            std::string::npos);
}

TEST(hbContainerReader, ChecksPadding) {
  const hbTestFolder folder;
  auto file = smallFile(folder);
  file[kHeader + 63] = std::byte{1}; // behind the 11 bytes of CRIT
  EXPECT_FILE_ERROR(
      file, "padding after chunk CRIT (dataset 0, step 0, component 0, key 0): expected a zero byte at offset 127");
}

TEST(hbContainerReader, AFileShortenedMeanwhileIsAnError) {
  const hbTestFolder folder;
  const auto file = smallFile(folder);
  const hbContainerReader reader(folder / "small.hbv", kKnown, kNoLimit);
  fs::resize_file(folder / "small.hbv", kHeader + 5);
  EXPECT_HB_ERROR(reader.read(*reader.find({"CRIT"})), "expected 6 more bytes at offset 69, found the end: shortened");
}

TEST(hbContainerReader, ReadsStoredBytesInPieces) {
  const hbTestFolder folder;
  std::vector<std::byte> big((std::size_t{5} << 19U) + 1); // 2.5 MiB and a byte: three pieces
  for (std::size_t i = 0; i < big.size(); ++i) big[i] = std::byte(i * i >> 8U);
  {
    hbContainerWriter writer(folder / "big.hbv");
    writer.add({"CRIT"}, hbChunkKind::critical, big, hbCodec::stored);
    writer.commit();
  }
  const hbContainerReader reader(folder / "big.hbv", kKnown, big.size());
  std::vector<std::byte> found;
  int pieces = 0;
  reader.readStored(reader.entries()[0], [&](std::span<const std::byte> piece) {
    found.insert(found.end(), piece.begin(), piece.end());
    ++pieces;
  });
  EXPECT_EQ(found, big);
  EXPECT_EQ(pieces, 3);
  EXPECT_EQ(reader.read(reader.entries()[0]), big);
}
