#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "scene/hbScene.h"
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

/// The field of a volume's labels; a scene that shows colours without a transfer function gets one that tells them
/// apart, with that unit length where one is given. Throws hbError for what is no plain volume.
std::shared_ptr<const hbField> labelField(const hbField& field, hbScene& scene, std::optional<double> unitLength);

/// Chooses an iso-value and stretches a transfer function, where the scene's mode needs them; the values' histogram, if
/// it was taken for that.
hbHistogram completeScene(hbScene& scene, const hbField& field, hbProgress& progress = hbProgress::none());

} // namespace hb
