#include "report/hbFieldDifference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <tuple>
#include <vector>

#include "volume/hbLatticeParts.h"
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
  const hbGeometry& geometry = reference.geometry();
  const hbLatticeParts parts(geometry.cubeCoordinates(0), geometry.cubeCoordinates(1), geometry.cubeCoordinates(2));
  const hbValueMap map = field.valueMap();
  progress.begin("measuring errors", size.x * size.y * size.z, "samples");
  return inParts(parts.count(), [&](std::int64_t index) {
    const hbLatticeParts::Part part = parts.part(index);
    std::vector<float> found(std::size_t(parts.samples(part)));
    std::vector<double> truth(static_cast<std::size_t>(size.x));
    parts.evaluate(field, component, part, found.data());
    hbErrorStatistics errors;
    for (std::int64_t row = 0; row < part.planes * part.rows; ++row) {
      reference.row(0, part.y + row % part.rows, part.z + row / part.rows, component, truth);
      for (std::size_t x = 0; x < truth.size(); ++x) {
        const double value = nonFinite && !std::isfinite(truth[x]) ? *nonFinite : truth[x];
        errors.add(value, map.toTrue(found[x + std::size_t(row * size.x)]));
      }
    }
    progress.advance(parts.samples(part));
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
  // A sample may cost the 2 MB of a file that the system maps at once. In the order of the file, few are mapped at a
  // time.
  constexpr std::size_t kBetweenReleases = 32;
  progress.begin("measuring errors", points, "samples");
  return inParts((points + kPart - 1) / kPart, [&](std::int64_t part) {
    struct Draw {
      hbSize3 sample{0};
      double truth = 0.0;
    };
    std::vector<Draw> draws(std::size_t(std::min(kPart, points - part * kPart)));
    Random random(part);
    for (Draw& draw : draws)
      for (int d = 0; d < 3; ++d) draw.sample[d] = std::int64_t(random.unit() * double(size[d]));

    std::vector<Draw*> ordered;
    for (Draw& draw : draws) ordered.push_back(&draw);
    std::sort(ordered.begin(), ordered.end(), [](const Draw* a, const Draw* b) {
      const hbSize3 &p = a->sample, &q = b->sample;
      return std::tie(p.z, p.y, p.x) < std::tie(q.z, q.y, q.x);
    });
    for (std::size_t first = 0; first < ordered.size(); first += kBetweenReleases) {
      const std::size_t end = std::min(first + kBetweenReleases, ordered.size());
      for (std::size_t i = first; i < end; ++i) {
        const hbSize3& sample = ordered[i]->sample;
        ordered[i]->truth = reference.value(sample.x, sample.y, sample.z, component);
      }
      reference.releasePlanes(ordered[first]->sample.z, ordered[end - 1]->sample.z);
    }

    hbErrorStatistics errors;
    for (const auto& [sample, truth] : draws) {
      glm::dvec3 place;
      for (int d = 0; d < 3; ++d) place[d] = size[d] == 1 ? 0.5 : double(sample[d]) / double(size[d] - 1);
      errors.add(nonFinite && !std::isfinite(truth) ? *nonFinite : truth, valueAt(place));
    }
    progress.advance(std::int64_t(draws.size()));
    return errors;
  });
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
