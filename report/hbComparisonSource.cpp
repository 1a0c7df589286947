#include "report/hbComparisonSource.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/hbCoarseGrid.h"
#include "report/hbFieldDifference.h"
#include "volume/hbError.h"
#include "volume/hbHistogram.h"
#include "volume/hbSampleType.h"
#include "volume/hbVolumeField.h"

namespace {

std::shared_ptr<const hbVolume> fullGrid(const hbInput& input, hbProgress& progress) {
  if (input.volume) return input.volume;
  const hbSize3 size = input.analytic->geometry().size;
  return std::make_shared<const hbVolume>(
      hbCoarseGrid::sample(*input.analytic, std::max({size.x, size.y, size.z}), progress));
}

} // namespace

hbComparisonSource::hbComparisonSource(const Open& open, int component, std::optional<double> nonFinite,
                                       std::uint64_t memoryLimit, hbProgress& progress)
    : open_(open), nonFinite_(nonFinite), component_(component), input_(open()) {
  if (input_.sparse) throw hbError(fmt::format("{}: expected a volume or a field, found a sparse grid", input_.name));
  if (component_ >= input_.components())
    throw hbError(fmt::format("{}: expected a component from 0 to {}, found {}", input_.name, input_.components() - 1,
                              component_));
  const double sampled = input_.analytic ? 4.0 * double(input_.geometry().samples()) : 0.0;
  if (sampled > double(memoryLimit))
    throw hbError(fmt::format("{}: its full grid needs {:.3g} MB, more than the memory limit of {:.3g} MB", input_.name,
                              sampled / 0x1p20, double(memoryLimit) / 0x1p20));
  volume_ = fullGrid(input_, progress);
  field_ = std::make_shared<const hbVolumeField>(*volume_, volume_->chooseValueMap(), nonFinite_);
  const hbHistogram histogram = hb::calcHistograms(*volume_, 1, progress)[std::size_t(component_)];
  if (histogram.nans + histogram.infinities > 0 && !nonFinite_)
    throw hbError(fmt::format("{}: expected finite samples, found {} NaN and {} infinite ones; --nan-value V replaces "
                              "them",
                              input_.name, histogram.nans, histogram.infinities));
  range_ = {histogram.min, histogram.max};
  // fmin and fmax leave out the NaN that a histogram without finite values has.
  if (histogram.nans + histogram.infinities > 0)
    range_ = {std::fmin(range_.first, *nonFinite_), std::fmax(range_.second, *nonFinite_)};
}

std::uint64_t hbComparisonSource::bytes() const {
  return std::uint64_t(volume_->geometry().samples()) * std::uint64_t(volume_->components()) *
         std::uint64_t(hb::sampleBytes(volume_->type()));
}

hbVolume hbComparisonSource::floats() const {
  const hbGeometry& geometry = volume_->geometry();
  const hbSize3 size = geometry.size;
  const hbValueMap map = field_->valueMap();
  std::vector<float> samples(std::size_t(geometry.samples()));
  field_->lattice(geometry.cubeCoordinates(0), geometry.cubeCoordinates(1), geometry.cubeCoordinates(2), component_,
                  samples.data(), std::size_t(size.x), std::size_t(size.x * size.y));
  if (!map.isIdentity())
    for (float& sample : samples) sample = float(map.toTrue(sample));
  return hbVolume::fromSamples(geometry, std::move(samples));
}

hbInput hbComparisonSource::load() const {
  hbInput input = open_();
  if (!input.volume) {
    input.volume = fullGrid(input, hbProgress::none());
    input.analytic = nullptr;
  }
  return input;
}

hbErrorStatistics hbComparisonSource::errors(const hbField& field, hbProgress& progress) const {
  if (!measuresAll()) return hb::fieldDifference(*field_, field, component_, kRandomPoints, progress);
  return hb::fieldVolumeDifference(*volume_, field, component_, nonFinite_, progress);
}

hbErrorStatistics hbComparisonSource::trueErrors(const hbField& field, hbProgress& progress) const {
  return hb::fieldDifference(*input_.analytic, field, component_, kRandomPoints, progress);
}
