// The `.hbv` reader: the container, every type of chunk, the sparse grid, and what the program then does with it.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/InfoJson.h"
#include "apps/InfoText.h"
#include "raycast/hbRaycaster.h"
#include "scene/hbScene.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "sparsegrid/hbSparseGridFile.h"
#include "tests/fuzz/fuzz.h"
#include "volume/hbContainerReader.h"

namespace {

constexpr std::uint64_t kMemory = std::uint64_t{1} << 20;

/// What decodes is encoded into bytes that decode to the same.
template <class Decode, class Encode>
void roundTrip(const std::vector<std::byte>& bytes, Decode decode, Encode encode) {
  fuzz::allowErrors([&] {
    const std::vector<std::byte> once = encode(decode(bytes));
    fuzz::expect(encode(decode(once)) == once);
  });
}

template <class Record>
void roundTrip(const std::vector<std::byte>& bytes) {
  roundTrip(
      bytes, [](const auto& from) { return Record::decode(from, "chunk"); },
      [](const Record& record) { return record.encode(); });
}

void decodeChunk(const hbContainerReader& reader, const hbChunkEntry& entry) {
  const std::vector<std::byte> bytes = reader.read(entry);
  if (entry.id.type == hbDatasetInfo::kType) roundTrip<hbDatasetInfo>(bytes);
  if (entry.id.type == hbErrorRecord::kType) roundTrip<hbErrorRecord>(bytes);
  if (entry.id.type == hbRangeRecord::kType) roundTrip<hbRangeRecord>(bytes);
  if (entry.id.type == hbProvenance::kType) roundTrip<hbProvenance>(bytes);
  if (entry.id.type == hbSparseGridFile::kIndexSet)
    roundTrip(
        bytes, [](const auto& from) { return hb::decodeIndexSet(from, "chunk"); }, hb::encodeIndexSet);
}

void evaluate(const hbField& field, const hbSparseGrid& grid) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::array<float, 6> x{0.0F, 1.0F, 0.3F, 0.5F, -7.0F, kNan}, y{0.0F, 1.0F, 0.9F, 0.5F, 0.2F, kNan},
      z{0.0F, 1.0F, 0.01F, 0.5F, 1e30F, kNan};
  std::array<float, 6> value{}, dx{}, dy{}, dz{};
  for (int c = 0; c < field.components(); ++c) {
    field.values({x, y, z}, c, value);
    // The range encloses the values, unless sums leave the range of floats.
    const auto stored = grid.surpluses(c);
    const hbRange range = field.range({}, c);
    if (std::all_of(stored.begin(), stored.end(), [](float s) { return std::abs(s) < 1e30F; }))
      for (const float v : value) fuzz::expect(v >= range.lo && v <= range.hi);
    field.gradients({x, y, z}, c, value, {dx, dy, dz});
    grid.calcValue({0.3, 0.6, 1.0}, c);
    constexpr std::array<double, 3> kXs{0.0, 0.4, 1.0}, kYs{0.1, 0.5, 1.0}, kZs{0.0, 0.7, 0.8};
    std::array<float, 27> lattice{};
    field.lattice(kXs, kYs, kZs, c, lattice.data(), 3, 9);
  }
}

/// What `info` and `render` ask of a file.
void use(const hbSparseGridFile& file) {
  nlohmann::ordered_json info;
  app::addSparseGrid(info, file);
  info["geometry"] = app::geometryJson(file.grid.geometry());
  info.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  app::infoText(info, false);
  evaluate(file.grid, file.grid);
  evaluate(hbSemiNodalGrid(file.grid), file.grid);
  const double combined = double(file.grid.indexSet().combinationValues()) * sizeof(float) * file.grid.components();
  if (combined <= double(kMemory)) evaluate(hbCombinationSparseGrid(file.grid), file.grid);
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
    hbScene scene;
    scene.mode = mode;
    scene.isoValue = 0.5;
    scene.width = scene.height = 2;
    scene.sampling.samples = 3;
    hbRaycaster(file.grid, scene).render();
    scene.sampling.samples = 0;
    scene.sampling.stepLength(file.grid.geometry(), scene.cameraFor(file.grid.geometry()));
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::allowErrors([&] {
    const hbContainerReader reader(std::as_bytes(std::span(data, size)), "fuzz.hbv", hbSparseGridFile::chunkTypes(),
                                   kMemory);
    for (const hbChunkEntry& entry : reader.entries()) fuzz::allowErrors([&] { decodeChunk(reader, entry); });
    fuzz::allowErrors([&] { use(hbSparseGridFile::read(reader)); });
    reader.verify();
  });
  return 0;
}
