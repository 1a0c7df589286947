#include "raycast/hbSceneDefaults.h"

#include <algorithm>
#include <vector>

#include "volume/hbParallel.h"

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
