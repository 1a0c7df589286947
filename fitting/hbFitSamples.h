#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sparsegrid/hbSparseGrid.h"
#include "volume/hbField.h"

/// What a sparse grid is fitted to: one component of a field at all samples of its geometry.
///
/// One in kHeldOutOne samples, spread irregularly and the same ones every time, is held out: no fit sees it, so that it
/// can tell whether a fit is any good.
class hbFitSamples {
public:
  static constexpr std::int64_t kHeldOutOne = 16;

  /// Keeps a reference to `source`, whose samples are those of `grid`'s geometry. Throws hbError where there are fewer
  /// than 64: too few to hold some out.
  hbFitSamples(const hbField& source, const hbSparseGrid& grid, int component);

  const hbSize3& size() const { return size_; }
  std::int64_t samplesOfPlane() const { return size_.x * size_.y; }
  std::int64_t count() const { return size_.x * size_.y * size_.z; }
  std::int64_t heldOutCount() const { return heldOutCount_; }
  std::int64_t fittedCount() const { return count() - heldOutCount_; }

  /// Where the samples of an axis lie in the grid's lattice (hbSparseGrid::latticeScale()), in [0,1], increasing.
  std::span<const double> coordinates(int axis) const { return coordinates_[std::size_t(axis)]; }

  /// The samples of one z, x fastest, samplesOfPlane() of them, in field values. Throws hbError where one is NaN or
  /// infinite. Threads may read several at once.
  void plane(std::int64_t z, std::span<float> out) const;

  /// Of the sample with that place among all of them, x fastest.
  static bool isHeldOut(std::int64_t sample);
  /// Whether it is one of an irregular choice of one in so many, whether held out or not.
  static bool isOneIn(std::int64_t many, std::int64_t sample);

private:
  const hbField& source_;
  int component_;
  hbSize3 size_;
  std::array<std::vector<double>, 3> places_;      ///< In the source's cube.
  std::array<std::vector<double>, 3> coordinates_; ///< In the grid's lattice.
  std::int64_t heldOutCount_ = 0;
};
