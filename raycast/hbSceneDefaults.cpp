#include "raycast/hbSceneDefaults.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "volume/hbError.h"
#include "volume/hbParallel.h"
#include "volume/hbVolumeField.h"

hbHistogram hb::fieldHistogram(const hbField& field, int component, hbProgress& progress) {
  constexpr std::int64_t kPoints = 64;
  const auto coordinates = [&](int d) {
    const std::int64_t count = std::min(kPoints, field.geometry().size[d]);
    std::vector<double> list;
    for (std::int64_t i = 0; i < count; ++i) list.push_back((double(i) + 0.5) / double(count));
    return list;
  };
  const std::vector<double> xs = coordinates(0), ys = coordinates(1), zs = coordinates(2);
  const std::size_t slice = xs.size() * ys.size();
  std::vector<float> values(slice * zs.size());
  progress.begin("sampling the histogram", std::int64_t(zs.size()), "slices");
  hb::parallelFor(std::int64_t(zs.size()), [&](std::int64_t index) {
    const auto k = std::size_t(index);
    field.lattice(xs, ys, {&zs[k], 1}, component, values.data() + k * slice, xs.size(), slice);
    progress.advance(1);
  });
  // Counted in field values, for those tell apart what floats of the true values would not.
  hbHistogram histogram = hb::calcHistogram(values);
  const hbValueMap map = field.valueMap();
  histogram.min = map.toTrue(histogram.min);
  histogram.max = map.toTrue(histogram.max);
  histogram.mean = map.toTrue(histogram.mean);
  histogram.deviation *= map.scale;
  histogram.fineStep *= map.scale;
  return histogram;
}

std::pair<double, double> hb::shownRange(const hbHistogram& histogram) {
  double lo = histogram.percentile(1.0 - kMostShown), hi = histogram.percentile(kMostShown);
  if (!(lo < hi)) lo = histogram.min, hi = histogram.max;
  const double width = (histogram.max - histogram.min) / double(histogram.bins.size());
  const auto fullest = std::max_element(histogram.bins.begin(), histogram.bins.end());
  const double usual = histogram.min + (double(fullest - histogram.bins.begin()) + 0.5) * width;
  constexpr double kLow = 0.25;
  if (usual > lo && usual < lo + kLow * (hi - lo)) lo = usual;
  return {lo, hi};
}

hbTransferFunction hb::transferFor(const std::optional<hbTransferFunction>& asked, const hbHistogram& histogram,
                                   const hbGeometry& geometry) {
  hbTransferFunction function = asked ? *asked : hbTransferFunction::preset("density");
  if (function.definition().relative) {
    auto [lo, hi] = shownRange(histogram);
    // What begins at about 0 goes away from it to one side alone.
    constexpr double kAbout = 0.1;
    if (function.definition().colorSpace == hbTransferFunction::ColorSpace::diverging && lo < kAbout * hi &&
        hi > kAbout * lo) {
      hi = std::max(-lo, hi);
      lo = -hi;
    }
    if (!(lo < hi))
      throw hbError(fmt::format("transfer function: expected values with a range, found {} everywhere; state a range",
                                histogram.min));
    function = function.rescaled(lo, hi);
  }
  if (function.definition().unitLength) return function;
  return function.withUnitLength(hbTransferFunction::defaultUnitLength(geometry));
}

std::shared_ptr<const hbField> hb::labelField(const hbField& field, hbScene& scene, std::optional<double> unitLength) {
  const auto* volume = dynamic_cast<const hbVolumeField*>(&field);
  if (volume == nullptr)
    throw hbError("--labels: expected a plain volume: what is compressed or computed has values between its samples");
  if (!scene.transfer && (scene.mode == hbMode::dvr || scene.mode == hbMode::slice)) {
    const hbRange range = field.range({}, scene.component);
    const double least = field.valueMap().toTrue(range.lo), greatest = field.valueMap().toTrue(range.hi);
    constexpr double kMost = 1 << 24; // whole numbers from there on are not all floats
    if (!(std::abs(least) < kMost && std::abs(greatest) < kMost))
      throw hbError(
          fmt::format("--labels: expected numbers between -{0} and {0}, found {1} to {2}", kMost, least, greatest));
    scene.transfer = hbTransferFunction::ofLabels(std::llround(least), std::llround(greatest));
    if (unitLength) scene.transfer = scene.transfer->withUnitLength(*unitLength);
  }
  return std::make_shared<const hbVolumeField>(volume->nearest());
}

hbHistogram hb::completeScene(hbScene& scene, const hbField& field, hbProgress& progress) {
  hbHistogram histogram;
  const bool isStretched = scene.mode == hbMode::dvr && (!scene.transfer || scene.transfer->definition().relative);
  if (scene.mode == hbMode::iso || isStretched) histogram = hb::fieldHistogram(field, scene.component, progress);
  if (scene.mode == hbMode::iso && !scene.isoValue) scene.isoValue = histogram.otsuThreshold();
  if (scene.mode == hbMode::dvr) scene.transfer = hb::transferFor(scene.transfer, histogram, field.geometry());
  return histogram;
}
