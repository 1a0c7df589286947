#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sparsegrid/hbHat.h"
#include "sparsegrid/hbIndexSet.h"
#include "volume/hbProgress.h"

/// The linear map A from a sparse grid's surpluses to its values at a lattice of samples, and its transpose, in 64
/// bits.
///
/// Axis by axis, as the `lattice` engine does it: for a plane the surpluses are summed over the levels of z; for a row
/// of it over those of y, which leaves one line of surpluses along x; this is dehierarchised and interpolated. The
/// transpose does the same backwards, and adds up planes in the order of z. So the outcome does not depend on the
/// number of threads, which take planes. O(samples) and, a plane, O(surpluses whose hats meet it).
class hbSampleOperator {
public:
  /// The samples' coordinates in the grid's lattice, in [0,1], increasing, x, y and z; one of a flat axis.
  hbSampleOperator(const hbIndexSet& set, const std::array<std::span<const double>, 3>& coordinates);

  /// Gets the values of one plane, x fastest, and may change them. Called once for each z, by several threads at once.
  using PlaneWork = std::function<void(std::int64_t z, std::span<double> values)>;

  /// Hands A `surpluses` to `work`.
  void apply(std::span<const double> surpluses, const PlaneWork& work,
             const hbProgress& progress = hbProgress::none()) const;
  /// out = transpose(A) v, with v what `fill` puts into planes of zeros.
  void applyTransposed(const PlaneWork& fill, std::span<double> out,
                       const hbProgress& progress = hbProgress::none()) const;
  /// out = transpose(A) v, with v what `work` makes of A `surpluses`; `out` may be `surpluses`. All three return early,
  /// with anything in `out`, once `progress` was cancelled.
  void applyBoth(std::span<const double> surpluses, const PlaneWork& work, std::span<double> out,
                 const hbProgress& progress = hbProgress::none()) const;

  /// The root of the mean of the squared values at the samples.
  double rootMeanSquare(std::span<const double> surpluses) const;

  /// How many planes are worked at at the same time.
  static double planesAtOnce(const hbSize3& samples);

  /// The memory that applyBoth() takes, in bytes.
  static double bytes(const hbIndexSet& set, const hbSize3& samples);

private:
  /// The subspaces of one level of y, summed over z: rows of surpluses along x, level after level.
  struct Rows {
    std::int64_t offset = 0, count = 0, length = 0;
  };
  static std::vector<Rows> rowsOf(const hbIndexSet& set);
  struct Workspace;

  void planeSums(std::span<const double> surpluses, std::int64_t z, std::span<double> sums) const;
  void planeValues(std::span<const double> sums, Workspace& workspace, std::span<double> values) const;
  void planeTransposed(std::span<const double> values, Workspace& workspace, std::span<double> sums) const;
  void gather(std::span<const double> sums, const hbSubspace& subspace, std::span<double> out) const;

  /// Calls visit(slot, level) for the one or two hats of a level (see hbHat).
  template <class Visit>
  static void forSlots(bool flat, int level, Visit visit);

  hbIndexSet set_;
  std::array<std::vector<hbHat<double>>, 2> hats_; ///< Of y and z at the samples.
  std::vector<std::int64_t> cell_;                 ///< Of x at the samples, on its finest level.
  std::vector<double> step_;                       ///< Where in the cell, in [0,1].
  std::vector<Rows> rows_;                         ///< By level of y.
  std::int64_t planeSize_ = 0;                     ///< Of all rows.
};
