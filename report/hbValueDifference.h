#pragma once

#include "report/hbErrorStatistics.h"
#include "volume/hbProgress.h"
#include "volume/hbVolume.h"

namespace hb {

/// The errors of `component` of volume `b` against the reference `a`, over all samples, in data values (slope and
/// intercept applied). Runs on all threads; the result does not depend on their number. Throws hbError for unlike sizes
/// or a component that one of them lacks. Reads both volumes once; takes little memory of its own.
hbErrorStatistics volumeDifference(const hbVolume& a, const hbVolume& b, int component = 0,
                                   hbProgress& progress = hbProgress::none());

} // namespace hb
