#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "raycast/hbInput.h"
#include "report/hbErrorStatistics.h"

/// What a comparison compares with: the full grid of samples, and of an analytic field also the field itself.
class hbComparisonSource {
public:
  using Open = std::function<hbInput()>;

  /// `open` opens the input anew, as often as it is asked. An analytic field's full grid is sampled here, with its
  /// nominal sizes. NaN and infinite samples count as `nonFinite`. Throws hbError for sparse grids, where the component
  /// is not there, for samples that are not finite and have nothing to count as, and for a full grid to be sampled
  /// that takes more than `memoryLimit` bytes.
  hbComparisonSource(const Open& open, int component, std::optional<double> nonFinite,
                     std::uint64_t memoryLimit = std::numeric_limits<std::uint64_t>::max(),
                     hbProgress& progress = hbProgress::none());

  const hbInput& input() const { return input_; }
  const hbVolume& volume() const { return *volume_; }
  std::shared_ptr<const hbVolume> sharedVolume() const { return volume_; }
  /// Trilinear between the samples.
  const hbField& field() const { return *field_; }
  std::shared_ptr<const hbAnalyticField> analytic() const { return input_.analytic; }
  /// Least and greatest sample, those that are not finite counted as what they are taken for.
  std::pair<double, double> range() const { return range_; }
  /// Bytes of the samples in their own type, all components.
  std::uint64_t bytes() const;
  /// The component's samples as 32-bit floats in data values, for other programs: 4 bytes a sample.
  hbVolume floats() const;
  /// The full grid read or sampled again: what it takes to have it.
  hbInput load() const;

  /// The samples (of a volume of more than kMeasureAll: kRandomPoints points between them) against a field on the same
  /// cube.
  hbErrorStatistics errors(const hbField& field, hbProgress& progress) const;
  bool measuresAll() const { return volume_->geometry().samples() <= kMeasureAll; }
  /// The analytic field at kRandomPoints points of the cube against that field; there must be one.
  hbErrorStatistics trueErrors(const hbField& field, hbProgress& progress) const;

  static constexpr std::int64_t kMeasureAll = std::int64_t{1} << 26;
  static constexpr std::int64_t kRandomPoints = std::int64_t{1} << 20;

private:
  Open open_;
  std::optional<double> nonFinite_;
  int component_;
  hbInput input_;
  std::shared_ptr<const hbVolume> volume_;
  std::shared_ptr<const hbField> field_;
  std::pair<double, double> range_;
};
