#include "report/hbSparseCompression.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "report/hbFieldDifference.h"
#include "volume/hbError.h"
#include "volume/hbHistogram.h"

namespace {

/// An analytic field has no samples of its own: at a given level it stands for the full grid of that level.
hbInput atLevel(hbInput input, int level) {
  if (!input.analytic || level == 0) return input;
  constexpr int kMax = 19; // 2^20 + 1 nodes an axis would be more than 2^60 samples
  if (level > kMax)
    throw hbError(
        fmt::format("{}: expected a level up to {} for an analytic field, found {}", input.name, kMax, level));
  hbSize3 size = input.analytic->geometry().size;
  for (int d = 0; d < 3; ++d)
    if (size[d] > 2) size[d] = (std::int64_t{1} << level) + 1;
  input.analytic = input.analytic->withSize(size);
  return input;
}

/// The trilinear field of a volume that may be larger than the memory, for looking at a little of it here and there:
/// each point may fill four stretches of a mapped file (64 kB each where the system has them at hand), so after every
/// few points they are let go of. Threads share the count; each adds a piece to what may be filled at a time.
class FrugalField final : public hbField {
public:
  FrugalField(std::shared_ptr<const hbField> field, hbVolume volume)
      : field_(std::move(field)), volume_(std::move(volume)) {}

  const hbGeometry& geometry() const override { return field_->geometry(); }
  int components() const override { return field_->components(); }
  hbValueMap valueMap() const override { return field_->valueMap(); }
  void values(const hbPoints& points, int component, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); i += kPiece) {
      const std::size_t count = std::min(kPiece, points.size() - i);
      field_->values(points.subspan(i, count), component, out.subspan(i, count));
      touched(count);
    }
  }
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override {
    field_->gradients(points, component, out, gradient);
    touched(points.size());
  }
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override {
    for (std::size_t k = 0; k < zs.size(); ++k)
      for (std::size_t j = 0; j < ys.size(); ++j) {
        field_->lattice(xs, {&ys[j], 1}, {&zs[k], 1}, component, out + j * strideY + k * strideZ, strideY, strideZ);
        touched(xs.size());
      }
  }
  hbRange range(const hbBox& box, int component) const override { return field_->range(box, component); }

private:
  static constexpr std::size_t kPiece = 16, kRelease = 256;

  void touched(std::size_t points) const {
    if ((count_ += points) < kRelease) return;
    count_ = 0;
    volume_.releasePages();
  }

  std::shared_ptr<const hbField> field_;
  hbVolume volume_;
  mutable std::atomic<std::size_t> count_{0};
};

bool mayScan(const hbInput& input) {
  return input.volume && input.geometry().samples() <= hbSparseCompression::kMeasureAll / input.components();
}

} // namespace

hbIndexSet hbSparseCompression::indexSet(const hbInput& input) const {
  const hbSize3 size = input.geometry().size;
  const hbIndexSet::Axes capped = hbIndexSet::axesOf(size);
  const int finest = level > 0 ? level : std::max({1, capped.maxLevel.x, capped.maxLevel.y, capped.maxLevel.z});
  const bool free = uncapped || (input.analytic && level > 0);
  const hbIndexSet::Axes axes = free ? hbIndexSet::uncappedAxesOf(size) : capped;
  if (!fullSet) return hbIndexSet::regular(finest, axes);
  return hbIndexSet::full({glm::min(axes.maxLevel, glm::ivec3(finest)), axes.flat});
}

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

hbErrorRecord hbSparseCompression::errorsOf(const hbInput& input, const hbField& source, const hbSparseGrid& grid,
                                            hbProgress& progress) const {
  using Reference = hbErrorRecord::Reference;
  const bool all = input.volume && (measure == Measure::all || (measure == Measure::automatic && mayScan(input)));
  hbErrorRecord record;
  for (int c = 0; c < grid.components(); ++c) {
    const hbErrorStatistics errors =
        all ? hb::fieldVolumeDifference(*input.volume, grid, c, nonFinite, progress)
            : hb::fieldDifference(source, grid, c, kRandomPoints, input.volume != nullptr, progress);
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

hbSparseGridFile hbSparseCompression::compress(const hbInput& original, hbProgress& progress) const {
  if (original.sparse)
    throw hbError(fmt::format("{}: expected a volume or a field, found a sparse grid", original.name));
  const hbInput input = atLevel(original, level);
  const hbIndexSet set = indexSet(input);
  // 8 bytes a node while hierarchising, 4 a component for the surpluses, and as much again while they are packed.
  const double need = double(set.storedValues()) * (12.0 + 8.0 * input.components());
  if (need > double(memoryLimit))
    throw hbError(fmt::format("{}: level {} needs about {:.0f} MB, more than the memory limit of {:.0f} MB", input.name,
                              set.number(), need / 0x1p20, double(memoryLimit) / 0x1p20));
  std::optional<hbRangeRecord> range;
  if (mayScan(input)) range = rangeOf(input, progress);

  auto source = input.field(hbEngine::full, nonFinite);
  if (input.volume && !mayScan(input)) source = std::make_shared<const FrugalField>(source, *input.volume);
  const auto interpolate = [&] {
    try {
      return hbSparseGrid::interpolate(*source, set, mapping, progress);
    } catch (const hbCancelled&) {
      throw;
    } catch (const hbError& error) {
      throw hbError(fmt::format("{}: {}", input.name, error.what()));
    }
  };
  hbSparseGridFile file{interpolate(), {}, std::move(range), {}, {}};
  if (input.volume) {
    file.info.sampleType = input.volume->type();
    file.info.slope = input.volume->slope();
    file.info.intercept = input.volume->intercept();
    file.info.componentNames = input.volume->componentNames();
  }
  if (measure != Measure::none) file.error = errorsOf(input, *source, file.grid, progress);
  return file;
}
