#pragma once

#include <cstdint>
#include <optional>

#include "report/hbErrorStatistics.h"
#include "volume/hbField.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

namespace hb {

/// The errors of a field against every sample of the volume it stands for, in true data values. NaN and infinite
/// samples count as `nonFinite` where it is given. The field is asked for whole lattices, at the samples' exact places.
/// Threads take slabs; the outcome does not depend on their number. `field.geometry()` must have the volume's sizes.
hbErrorStatistics fieldVolumeDifference(const hbVolume& reference, const hbField& field, int component,
                                        std::optional<double> nonFinite = std::nullopt,
                                        hbProgress& progress = hbProgress::none());

/// The same at `count` randomly chosen samples, the same ones every time: for volumes too large to be read whole. Of a
/// mapped volume, what was read is released now and then, so that memory stays bounded.
hbErrorStatistics sampledVolumeDifference(const hbVolume& reference, const hbField& field, int component,
                                          std::int64_t count, std::optional<double> nonFinite = std::nullopt,
                                          hbProgress& progress = hbProgress::none());

/// The errors of a field against another one at `points` random points of the cube, the same ones every time.
hbErrorStatistics fieldDifference(const hbField& reference, const hbField& field, int component, std::int64_t points,
                                  hbProgress& progress = hbProgress::none());

} // namespace hb
