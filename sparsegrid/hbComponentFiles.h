#pragma once

#include <string>

#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbVolumeReader.h"

namespace hb {

/// The sparse grid of a combination solution whose component grids lie in files: one volume of (2^i+1) x (2^j+1) x
/// (2^k+1) samples each, named after its levels by `pattern`, such as "u_{i}_{j}_{k}.nrrd" (the three braces once each,
/// in the file's name, not its folder).
///
/// The index set is what the files found enclose: every index with no greater levels than one of them. Files of grids
/// with coefficient 0 may be missing; others may not. An axis is flat where the files have one sample along it. All
/// components are read. The files must fill the same box of the world; where none says where it lies (origin 0, spacing
/// 1) it is the unit cube. Throws hbError naming the pattern or the file.
hbSparseGrid readComponentGrids(const std::string& pattern, const hbReadOptions& options = {},
                                hbProgress& progress = hbProgress::none());

} // namespace hb
