#pragma once

#include "volume/hbField.h"
#include "volume/hbHistogram.h"
#include "volume/hbProgress.h"

namespace hb {

/// The histogram of a field's true values on a lattice of at most 64 points an axis, midpoints of equal cells: what a
/// scene that was asked for nothing goes by.
hbHistogram fieldHistogram(const hbField& field, int component, hbProgress& progress = hbProgress::none());

} // namespace hb
