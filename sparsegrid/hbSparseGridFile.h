#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbContainerFormat.h"
#include "volume/hbContainerReader.h"
#include "volume/hbDatasetInfo.h"
#include "volume/hbErrorRecord.h"
#include "volume/hbProvenance.h"
#include "volume/hbRangeRecord.h"

/// A sparse grid as an `.hbv` file: the chunks INDX (index set) and SURP (surpluses, one a component) beside those
/// every representation has. doc/formats.md describes them byte by byte.
struct hbSparseGridFile {
  static constexpr hbChunkType kIndexSet{"INDX"};
  static constexpr hbChunkType kSurpluses{"SURP"};
  /// Every chunk type that read() understands.
  static std::vector<hbChunkType> chunkTypes();

  hbSparseGrid grid;
  /// Of the source. Geometry, value map, mapping and number of components are the grid's own when written.
  hbDatasetInfo info;
  std::optional<hbRangeRecord> range;
  std::optional<hbErrorRecord> error;
  hbProvenance provenance;

  /// Whether the file holds a sparse grid.
  static bool isIn(const hbContainerReader& reader);

  /// Throws hbError for a damaged file, an index set that is none, or one that does not fit its surpluses. Checks the
  /// size against the reader's memory limit before allocating.
  static hbSparseGridFile read(const hbContainerReader& reader);

  /// Writes the file whole or not at all. Throws hbError where it cannot be written.
  void write(const std::filesystem::path& path) const;
};

namespace hb {

/// The payload of INDX. u8 basis (0: hat), u8 flat axes (bit d), u16 zero, u32 number of subspaces; for each subspace,
/// in the order of hbIndexSet::subspaces(): u8 lx, ly, lz, zero, f32 quantiser step (0: not quantised).
std::vector<std::byte> encodeIndexSet(const hbIndexSet& set);

/// Throws hbError, beginning with `what`, for anything else.
hbIndexSet decodeIndexSet(std::span<const std::byte> bytes, const std::string& what);

} // namespace hb
