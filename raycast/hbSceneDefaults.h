#pragma once

#include <optional>
#include <utility>

#include "scene/hbTransferFunction.h"
#include "volume/hbField.h"
#include "volume/hbHistogram.h"
#include "volume/hbProgress.h"

namespace hb {

/// The histogram of a field's true values on a lattice of at most 64 points an axis, midpoints of equal cells: what a
/// scene that was asked for nothing goes by.
hbHistogram fieldHistogram(const hbField& field, int component, hbProgress& progress = hbProgress::none());

/// The values that a relative transfer function is stretched over: all but the share 1 - kMostShown at either end, so
/// that outliers do not determine it; from the most frequent value on where that lies in the lowest quarter, for then
/// it is the emptiness around things (of which interpolation may make values below it). All values where the rest are
/// equal.
std::pair<double, double> shownRange(const hbHistogram& histogram);
inline constexpr double kMostShown = 0.998;

/// What a DVR picture takes: `asked`, or where there is none the preset `density`. One that is relative goes over
/// shownRange(), a diverging one over as much on either side of 0 where there are values of both signs; one that states
/// no unit length gets hbTransferFunction::defaultUnitLength(). Throws hbError for values without a range.
hbTransferFunction transferFor(const std::optional<hbTransferFunction>& asked, const hbHistogram& histogram,
                               const hbGeometry& geometry);

} // namespace hb
