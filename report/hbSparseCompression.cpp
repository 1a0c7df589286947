#include "report/hbSparseCompression.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/hbFieldDifference.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "volume/hbError.h"
#include "volume/hbHistogram.h"

namespace {

bool mayScan(const hbInput& input) {
  return input.volume && input.geometry().samples() <= hbSparseCompression::kMeasureAll / input.components();
}

} // namespace

hbRangeRecord hbSparseCompression::rangeOf(const hbInput& input, hbProgress& progress) const {
  hbRangeRecord record;
  for (const hbHistogram& h : hb::calcHistograms(*input.volume, 1, progress)) {
    const bool replaced = h.nans + h.infinities > 0;
    if (replaced && !nonFinite)
      throw hbError(
          fmt::format("{}: expected finite samples, found {} NaN and {} infinite ones; --nan-value V replaces them",
                      input.name, h.nans, h.infinities));
    // fmin and fmax leave out the NaN that a histogram without finite values has.
    record.components.push_back(
        {replaced ? std::fmin(h.min, *nonFinite) : h.min, replaced ? std::fmax(h.max, *nonFinite) : h.max});
  }
  return record;
}

namespace {

/// At random points, where the semi-nodal form of the same function is the fast one.
hbErrorStatistics againstField(const hbField& source, const hbSparseGrid& grid, int component, hbProgress& progress) {
  constexpr std::int64_t kPoints = hbSparseCompression::kRandomPoints;
  if (!hbSemiNodalGrid::fits(grid.indexSet())) return hb::fieldDifference(source, grid, component, kPoints, progress);
  return hb::fieldDifference(source, hbSemiNodalGrid(grid), component, kPoints, progress);
}

} // namespace

hbErrorRecord hbSparseCompression::errorsOf(const hbInput& input, const hbField& source, const hbSparseGrid& grid,
                                            hbProgress& progress) const {
  using Reference = hbErrorRecord::Reference;
  const bool all = input.volume && (measure == Measure::all || (measure == Measure::automatic && mayScan(input)));
  hbErrorRecord record;
  for (int c = 0; c < grid.components(); ++c) {
    const auto valueAt = [&](const glm::dvec3& p) { return grid.valueMap().toTrue(grid.calcValue(p, c)); };
    const hbErrorStatistics errors =
        all            ? hb::fieldVolumeDifference(*input.volume, grid, c, nonFinite, progress)
        : input.volume ? hb::randomSampleDifference(*input.volume, valueAt, c, kRandomSamples, nonFinite, progress)
                       : againstField(source, grid, c, progress);
    if (!std::isfinite(errors.max))
      throw hbError(fmt::format("{}: expected finite samples, found NaN or infinite ones; --nan-value V replaces them",
                                input.name));
    const double same = std::numeric_limits<double>::infinity(), unknown = std::numeric_limits<double>::quiet_NaN();
    record.components.push_back({all            ? Reference::allSamples
                                 : input.volume ? Reference::randomSamples
                                                : Reference::analyticField,
                                 hbErrorRecord::Kind::measured, std::uint64_t(errors.count), errors.max, errors.rmse(),
                                 errors.psnr().value_or(errors.max == 0.0 ? same : unknown)});
  }
  return record;
}

hbSparseCompression::Result hbSparseCompression::compress(const hbInput& original, hbProgress& progress) const {
  if (original.sparse)
    throw hbError(fmt::format("{}: expected a volume or a field, found a sparse grid", original.name));
  const hbInput input = set.inputFor(original);
  const hbIndexSet indexSet = set.indexSet(input);
  // For each node and component 8 bytes while hierarchising and 4 for the surpluses, as much again for the form that
  // errors are measured with, and while they are packed; and something for what is being read.
  const double grid = double(indexSet.storedValues()) * (12.0 + 12.0 * input.components());
  const double need = grid + (fit ? fit->bytes(indexSet, input.geometry().size) : 0.0);
  if (need > double(memoryLimit))
    throw hbError(fmt::format("{}: level {} needs about {:.3g} MB, more than the memory limit of {:.3g} MB", input.name,
                              indexSet.number(), need / 0x1p20, double(memoryLimit) / 0x1p20));
  if (input.volume && !mayScan(input)) input.volume->adviseScatteredReads();
  std::optional<hbRangeRecord> range;
  if (mayScan(input)) range = rangeOf(input, progress);

  const auto source = input.field(hbEngine::full, nonFinite);
  // What fails of the data is said of this input.
  const auto named = [&](const auto& work) {
    try {
      return work();
    } catch (const hbCancelled&) {
      throw;
    } catch (const hbError& error) {
      throw hbError(fmt::format("{}: {}", input.name, error.what()));
    }
  };
  Result result{{named([&] {
                   if (!input.volume) return hbSparseGrid::interpolate(*source, indexSet, mapping, progress);
                   return hbSparseGrid::interpolate(
                       *source, indexSet, mapping, progress,
                       [&](std::int64_t first, std::int64_t last) { input.volume->releasePlanes(first, last); });
                 }),
                 {},
                 std::move(range),
                 {},
                 {}},
                {}};
  hbSparseGridFile& file = result.file;
  if (fit) {
    hbFit how = *fit;
    how.memoryLimit = memoryLimit - std::uint64_t(grid);
    hbFit::Result fitted = named([&] { return how.run(*source, file.grid, progress); });
    file.grid = std::move(fitted.grid);
    result.fits = std::move(fitted.reports);
  }
  if (input.volume) {
    input.volume->releasePages();
    file.info.sampleType = input.volume->type();
    file.info.slope = input.volume->slope();
    file.info.intercept = input.volume->intercept();
    file.info.componentNames = input.volume->componentNames();
  }
  if (measure != Measure::none) {
    try {
      file.error = errorsOf(input, *source, file.grid, progress);
    } catch (const hbCancelled&) {
      // Who asked for the best so far wants it with its errors.
      if (!fit || !fit->keepBest) throw;
      file.error = errorsOf(input, *source, file.grid, hbProgress::none());
    }
  }
  return result;
}
