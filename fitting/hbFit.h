#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "fitting/hbFitLoss.h"
#include "fitting/hbFitReport.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbField.h"
#include "volume/hbProgress.h"

/// Fits a sparse grid to all samples of a field, where interpolation looks at those at its nodes only.
struct hbFit {
  enum class Method : std::uint8_t { opticom, leastSquares };
  enum class Solver : std::uint8_t { automatic, ceres, conjugateGradient };

  /// Fitted surpluses are rounded to multiples of a power of two, by which values change by no more than this share of
  /// the residuals (of a robust loss, of those within the threshold), as roots of mean squares: 0.5 % is added to the
  /// RMSE, and a file has a quarter of the bytes.
  static constexpr double kRounding = 0.1;

  /// Up to so many bytes, and those of memoryLimit, Solver::automatic takes Ceres: where it needs more, it takes
  /// up to a thousand times as long as conjugate gradients without a matrix (doc/fitting.md).
  static constexpr double kCeresBytes = 0x1p22;

  /// Of these some 64 are held out. Beyond the most, a fit would take hours.
  static constexpr std::int64_t kFewestSamples = 1024, kMostSamples = std::int64_t{1} << 31;

  Method method = Method::leastSquares;
  hbFitLoss::Kind loss = hbFitLoss::Kind::none;
  std::optional<double> threshold;   ///< Of a robust loss, in data values, > 0; none: from the residuals.
  std::optional<double> smoothing;   ///< Of least squares, >= 0, see hbLeastSquares; none: by the samples held out.
  Solver solver = Solver::automatic; ///< Of least squares.
  std::uint64_t memoryLimit = std::numeric_limits<std::uint64_t>::max(); ///< Bytes.
  bool keepBest = false; ///< Cancelled, hand back the best so far instead of throwing.

  struct Result {
    hbSparseGrid grid;
    std::vector<hbFitReport> reports; ///< One a component.
  };

  /// Each component by itself. `interpolated` interpolates `source` on the index set that is wanted; a component whose
  /// fit does not cost less, or has no smaller RMSE, on the samples held out keeps it. Throws hbError where samples are
  /// not finite, too few, or do not determine a fit without smoothing, and where the memory does not suffice;
  /// hbCancelled.
  Result run(const hbField& source, const hbSparseGrid& interpolated, hbProgress& progress = hbProgress::none()) const;

  /// What run() takes at its peak beside the interpolating grid, in bytes; with Solver::ceres more, see hbCeresSolver.
  double bytes(const hbIndexSet& set, const hbSize3& samples) const;

private:
  void check(const hbSize3& samples) const;
};
