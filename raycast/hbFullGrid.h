#pragma once

#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

namespace hb {

/// The samples of the volume that a sparse grid stands for, all components, as a plain volume of 32-bit floats (with
/// the grid's value map as slope and intercept): the sparse-grid paper's first way to draw one, section 4. Plane by
/// plane in parallel; 4 bytes a sample and component. Throws hbCancelled.
hbVolume extractFullGrid(const hbSparseGrid& grid, hbProgress& progress = hbProgress::none());

/// What that takes, in bytes.
double fullGridBytes(const hbSparseGrid& grid);

} // namespace hb
