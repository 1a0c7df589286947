#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include <glm/vec3.hpp>

#include "report/hbErrorStatistics.h"
#include "volume/hbField.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

namespace hb {

/// The errors of a field against every sample of the volume it stands for, in true data values. NaN and infinite
/// samples count as `nonFinite` where it is given. The field is asked for whole lattices, at the samples' exact places.
/// Threads take parts (hbLatticeParts); the outcome does not depend on their number. The field may have other sizes
/// than the volume: its cube is the volume's.
hbErrorStatistics fieldVolumeDifference(const hbVolume& reference, const hbField& field, int component,
                                        std::optional<double> nonFinite = std::nullopt,
                                        hbProgress& progress = hbProgress::none());

/// The same at `points` random samples of a volume too large to be read whole, the same ones every time; a sample may
/// be drawn twice. `valueAt` gives the true data value at a point of the cube and is called by several threads. Of a
/// mapped volume, 32 samples a thread are in memory at a time, with the up to 2 MB that the system maps around each.
hbErrorStatistics randomSampleDifference(const hbVolume& reference,
                                         const std::function<double(const glm::dvec3& point)>& valueAt, int component,
                                         std::int64_t points, std::optional<double> nonFinite = std::nullopt,
                                         hbProgress& progress = hbProgress::none());

/// The errors of a field against another one at `points` random points of the cube, the same ones every time.
hbErrorStatistics fieldDifference(const hbField& reference, const hbField& field, int component, std::int64_t points,
                                  hbProgress& progress = hbProgress::none());

} // namespace hb
