#include "report/hbFieldDifference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "volume/hbParallel.h"

namespace {

/// Runs part(i) for i < count on all threads and merges the outcomes in order.
hbErrorStatistics inParts(std::int64_t count, const std::function<hbErrorStatistics(std::int64_t)>& part) {
  std::vector<hbErrorStatistics> parts(static_cast<std::size_t>(count));
  hb::parallelFor(count, [&](std::int64_t i) { parts[std::size_t(i)] = part(i); });
  hbErrorStatistics sum;
  for (const hbErrorStatistics& one : parts) sum.merge(one);
  return sum;
}

} // namespace

hbErrorStatistics hb::fieldVolumeDifference(const hbVolume& reference, const hbField& field, int component,
                                            std::optional<double> nonFinite, hbProgress& progress) {
  const hbSize3 size = reference.geometry().size;
  assert(field.geometry().size == size);
  const auto xs = reference.geometry().cubeCoordinates(0), ys = reference.geometry().cubeCoordinates(1),
             zs = reference.geometry().cubeCoordinates(2);
  const hbValueMap map = field.valueMap();
  // Slabs of some ten thousand samples: rows enough for a thread, memory little.
  const std::int64_t rows = std::clamp<std::int64_t>(65536 / size.x, 1, size.y), slabs = (size.y + rows - 1) / rows;
  progress.begin("measuring errors", size.z * slabs, "slabs");
  return inParts(size.z * slabs, [&](std::int64_t part) {
    const std::int64_t z = part / slabs, y0 = part % slabs * rows, count = std::min(rows, size.y - y0);
    std::vector<float> found(std::size_t(size.x * count));
    std::vector<double> truth(static_cast<std::size_t>(size.x));
    field.lattice(xs, {ys.data() + y0, std::size_t(count)}, {zs.data() + z, 1}, component, found.data(),
                  std::size_t(size.x), found.size());
    hbErrorStatistics errors;
    for (std::int64_t y = 0; y < count; ++y) {
      reference.row(0, y0 + y, z, component, truth);
      for (std::size_t x = 0; x < truth.size(); ++x) {
        const double value = nonFinite && !std::isfinite(truth[x]) ? *nonFinite : truth[x];
        errors.add(value, map.toTrue(found[x + std::size_t(y * size.x)]));
      }
    }
    progress.advance(1);
    return errors;
  });
}

namespace {

constexpr std::int64_t kPart = 8192; // random points of one task

/// Uniform in [0,1); each part of the work has a generator of its own, so that threads do not matter.
class Random {
public:
  explicit Random(std::int64_t part) : engine_(std::uint64_t(part)) {}
  double unit() { return double(engine_() >> 11U) * 0x1p-53; }

private:
  std::mt19937_64 engine_;
};

} // namespace

hbErrorStatistics hb::randomSampleDifference(const hbVolume& reference,
                                             const std::function<double(const glm::dvec3& point)>& valueAt,
                                             int component, std::int64_t points, std::optional<double> nonFinite,
                                             hbProgress& progress) {
  const hbSize3 size = reference.geometry().size;
  // A sample costs a page of a mapped file: two parts at a time are 64 MB.
  constexpr std::int64_t kPartsBetweenReleases = 2;
  const std::int64_t parts = (points + kPart - 1) / kPart;
  progress.begin("measuring errors", points, "samples");
  hbErrorStatistics sum;
  for (std::int64_t first = 0; first < parts; first += kPartsBetweenReleases) {
    sum.merge(inParts(std::min(kPartsBetweenReleases, parts - first), [&](std::int64_t offset) {
      const std::int64_t part = first + offset, own = std::min(kPart, points - part * kPart);
      Random random(part);
      hbErrorStatistics errors;
      for (std::int64_t i = 0; i < own; ++i) {
        hbSize3 sample;
        glm::dvec3 place;
        for (int d = 0; d < 3; ++d) {
          sample[d] = std::int64_t(random.unit() * double(size[d]));
          place[d] = size[d] == 1 ? 0.5 : double(sample[d]) / double(size[d] - 1);
        }
        const double truth = reference.value(sample.x, sample.y, sample.z, component);
        errors.add(nonFinite && !std::isfinite(truth) ? *nonFinite : truth, valueAt(place));
      }
      progress.advance(own);
      return errors;
    }));
    reference.releasePages();
  }
  return sum;
}

hbErrorStatistics hb::fieldDifference(const hbField& reference, const hbField& field, int component,
                                      std::int64_t points, hbProgress& progress) {
  const hbValueMap map = field.valueMap(), referenceMap = reference.valueMap();
  progress.begin("measuring errors", points, "points");
  return inParts((points + kPart - 1) / kPart, [&](std::int64_t part) {
    const std::size_t own = std::size_t(std::min(kPart, points - part * kPart));
    Random random(part);
    std::vector<float> x(own), y(own), z(own), truth(own), found(own);
    for (std::size_t i = 0; i < own; ++i) {
      x[i] = float(random.unit());
      y[i] = float(random.unit());
      z[i] = float(random.unit());
    }
    reference.values({x, y, z}, component, truth);
    field.values({x, y, z}, component, found);
    hbErrorStatistics errors;
    for (std::size_t i = 0; i < own; ++i) errors.add(referenceMap.toTrue(truth[i]), map.toTrue(found[i]));
    progress.advance(std::int64_t(own));
    return errors;
  });
}
