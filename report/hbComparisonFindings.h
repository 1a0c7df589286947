#pragma once

#include "report/hbComparison.h"
#include "report/hbReportJson.h"

/// What follows from the figures of a comparison's report.
namespace hb {

/// Adds to each case that was drawn whether it is on its mode's Pareto front: "pareto_time" (the median frame against
/// the picture's RMSE) and "pareto_bytes" (compressed bytes against it). Cases of other programs ("image_only") show
/// 8-bit pictures, whose errors are no such figures: they are on none.
void markParetoFronts(ReportJson& report);

/// Adds to each choice of a kind that has a mesh width h the orders of convergence since the coarser choice of that
/// kind before it, log(RMSE before / RMSE) / log(h before / h): "order" of the samples, "true_order" of an analytic
/// field. h is 2^-level of a sparse grid and the distance of nodes of a full one. Null where there is none before, or
/// an error is 0.
void addConvergenceOrders(ReportJson& report);

/// Adds "recommendations": for a greatest error, for a frame's time and for a number of bytes, the choice that serves
/// best, and what fits are good for, in one sentence each. A limit that is not given is 1 % of the values' range, a
/// tenth of a second, and 1 % of the uncompressed bytes.
///
/// - max error <= E: of the choices whose samples are off by no more, the one with the fewest bytes.
/// - a frame <= T, for each mode: of the cases that are as fast, the one with the least picture error, and among equals
///   the fewest bytes; where that is the volume itself, the best compressed one is named, too.
/// - <= B bytes: of the choices as small, the one with the least RMSE.
/// - for each way to fit, without a limit: the level at which it lessens the RMSE of interpolation by the greatest
///   factor, with bytes and time of both, and what interpolation reaches in as many bytes.
void addRecommendations(ReportJson& report, const hbComparison::Limits& limits);

} // namespace hb
