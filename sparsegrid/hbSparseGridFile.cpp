#include "sparsegrid/hbSparseGridFile.h"

#include <cstring>

#include <fmt/format.h>

#include "volume/hbByteReader.h"
#include "volume/hbByteWriter.h"
#include "volume/hbContainerWriter.h"
#include "volume/hbError.h"

std::vector<hbChunkType> hbSparseGridFile::chunkTypes() {
  return {hbDatasetInfo::kType, kIndexSet, kSurpluses, hbErrorRecord::kType, hbRangeRecord::kType, hbProvenance::kType};
}

std::vector<std::byte> hb::encodeIndexSet(const hbIndexSet& set) {
  hbByteWriter writer;
  writer.u8(0);
  writer.u8(std::uint8_t((set.flat().x ? 1 : 0) + (set.flat().y ? 2 : 0) + (set.flat().z ? 4 : 0)));
  writer.zeros(2);
  writer.u32(std::uint32_t(set.subspaces().size()));
  for (const hbSubspace& subspace : set.subspaces()) {
    for (int d = 0; d < 3; ++d) writer.u8(std::uint8_t(subspace.levels[d]));
    writer.zeros(1);
    writer.f32(0.0F);
  }
  return writer.take();
}

hbIndexSet hb::decodeIndexSet(std::span<const std::byte> bytes, const std::string& what) {
  hbByteReader reader(bytes, what);
  if (const int basis = reader.u8(); basis != 0)
    throw hbError(fmt::format("{}: expected the hat basis (0), found basis {}", what, basis));
  const int flatBits = reader.u8();
  if (flatBits > 7) throw hbError(fmt::format("{}: expected flat axes as three bits, found {}", what, flatBits));
  const glm::bvec3 flat((flatBits & 1) != 0, (flatBits & 2) != 0, (flatBits & 4) != 0);
  reader.zeros(2);
  const std::uint32_t count = reader.u32();
  constexpr std::uint64_t kEntryBytes = 8;
  if (reader.remaining() != count * kEntryBytes)
    throw hbError(fmt::format("{}: expected {} subspaces of {} bytes, found {} bytes", what, count, kEntryBytes,
                              reader.remaining()));
  std::vector<glm::ivec3> levels;
  for (std::uint32_t i = 0; i < count; ++i) {
    glm::ivec3 l;
    for (int d = 0; d < 3; ++d) l[d] = reader.u8();
    levels.push_back(l);
    reader.zeros(1);
    if (const float step = reader.f32(); step != 0.0F)
      throw hbError(fmt::format("{}: expected surpluses that are not quantised, found the step {}", what, step));
  }
  reader.finish();
  hbIndexSet set = hbIndexSet::fromList(levels, flat, what);
  for (std::size_t i = 0; i < levels.size(); ++i)
    if (levels[i] != set.subspaces()[i].levels)
      throw hbError(fmt::format("{}: expected the subspaces ordered by level, then z, y, x", what));
  return set;
}

bool hbSparseGridFile::isIn(const hbContainerReader& reader) { return reader.find({kIndexSet}) != nullptr; }

namespace {

/// The chunk of that id, unpacked; it must be there.
std::vector<std::byte> readRequired(const hbContainerReader& reader, const hbChunkId& id) {
  const hbChunkEntry* entry = reader.find(id);
  if (entry == nullptr)
    throw hbError(fmt::format("{}: expected a {}, found none", reader.path().string(), hb::describe(id)));
  return reader.read(*entry);
}

template <class Record>
std::optional<Record> readOptional(const hbContainerReader& reader, const std::string& name) {
  const hbChunkEntry* entry = reader.find({Record::kType});
  if (entry == nullptr) return std::nullopt;
  return Record::decode(reader.read(*entry), fmt::format("{}: {}", name, Record::kType.text()));
}

} // namespace

hbSparseGridFile hbSparseGridFile::read(const hbContainerReader& reader) {
  const std::string name = reader.path().string();
  const hbDatasetInfo info = hbDatasetInfo::decode(readRequired(reader, {hbDatasetInfo::kType}), name + ": GEOM");
  const hbIndexSet set = hb::decodeIndexSet(readRequired(reader, {kIndexSet}), name + ": INDX");
  const std::uint64_t bytes = std::uint64_t(set.storedValues()) * sizeof(float);
  // All components, and one more while it is unpacked.
  if (double(bytes) * double(info.components() + 1) > double(reader.memoryLimit()))
    throw hbError(
        fmt::format("{}: expected to need at most {} bytes (the memory limit), found {} components of {} bytes", name,
                    reader.memoryLimit(), info.components(), bytes));

  std::vector<std::vector<float>> surpluses;
  for (std::size_t c = 0; c < info.components(); ++c) {
    const hbChunkId id{kSurpluses, 0, 0, std::uint32_t(c)};
    const hbChunkEntry* entry = reader.find(id);
    if (entry == nullptr || entry->rawSize != bytes)
      throw hbError(fmt::format("{}: {}: expected {} bytes for the index set's {} values, found {}", name,
                                hb::describe(id), bytes, set.storedValues(),
                                entry == nullptr ? "no such chunk" : std::to_string(entry->rawSize)));
    const std::vector<std::byte> raw = reader.read(*entry);
    std::vector<float>& values = surpluses.emplace_back(std::size_t(set.storedValues()));
    std::memcpy(values.data(), raw.data(), raw.size());
  }
  const auto grid = [&] {
    try {
      return hbSparseGrid::fromSurpluses({info.geometry, info.valueMap, info.mapping}, set, std::move(surpluses));
    } catch (const hbError& error) {
      throw hbError(fmt::format("{}: {}", name, error.what()));
    }
  };
  return {grid(), info, readOptional<hbRangeRecord>(reader, name), readOptional<hbErrorRecord>(reader, name),
          readOptional<hbProvenance>(reader, name).value_or(hbProvenance())};
}

void hbSparseGridFile::write(const std::filesystem::path& path) const {
  hbDatasetInfo own = info;
  own.geometry = grid.geometry();
  own.valueMap = grid.valueMap();
  own.mapping = grid.frame().mapping;
  own.componentNames.resize(std::size_t(grid.components()));
  hbContainerWriter writer(path);
  const auto add = [&](const auto& record) {
    using Record = std::decay_t<decltype(record)>;
    writer.add({Record::kType}, Record::kKind, record.encode(), hbCodec::zstd);
  };
  add(own);
  writer.add({kIndexSet}, hbChunkKind::critical, hb::encodeIndexSet(grid.indexSet()), hbCodec::zstd);
  for (int c = 0; c < grid.components(); ++c)
    writer.add({kSurpluses, 0, 0, std::uint32_t(c)}, hbChunkKind::critical, std::as_bytes(grid.surpluses(c)),
               hbCodec::planesZstd);
  if (range) add(*range);
  if (error) add(*error);
  add(provenance);
  writer.commit();
}
