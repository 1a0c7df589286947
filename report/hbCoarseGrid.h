#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/hbField.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

/// A plain full grid, coarser than the field it is taken from: what any compressed form has to beat. Its nodes take the
/// field's values, as a sparse grid's do, and its cube is the field's; between nodes it is trilinear.
struct hbCoarseGrid {
  hbVolume volume; ///< 32-bit floats, all components, x fastest, components side by side.
  /// The samples packed as `.hbv` files pack surpluses (hbCodec::planesZstd).
  std::vector<std::byte> packed;

  /// A field at the nodes of a full grid with `longest` nodes along the axis with the most samples, at least 2, and in
  /// proportion along the others: the nearest number, at least 2; a flat axis stays flat. O(nodes). Throws hbCancelled.
  static hbVolume sample(const hbField& source, std::int64_t longest, hbProgress& progress = hbProgress::none());
  /// The same, and packed.
  static hbCoarseGrid take(const hbField& source, std::int64_t longest, hbProgress& progress = hbProgress::none());

  /// The finest one whose packed samples take no more than `bytes`, no finer than the source's own samples; where even
  /// 2 nodes an axis exceed that, those. Packed sizes do not grow evenly: of sizes beyond one that fits and a next one
  /// that does not, those up to twice as fine (and 128 nodes) are tried.
  static hbCoarseGrid within(const hbField& source, std::uint64_t bytes, hbProgress& progress = hbProgress::none());

  /// The volume that `packed` holds: what reading it takes.
  static hbVolume unpack(const hbVolume& like, const std::vector<std::byte>& packed);
};
