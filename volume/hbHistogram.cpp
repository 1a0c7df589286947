#include "volume/hbHistogram.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kFineBins = 65536;
// Values a block: sums are formed block by block and added in the order of the blocks, whatever thread made them.
constexpr std::int64_t kBlock = 65536;

/// Values as runs of at most kBlock: `read(run, out)` fills out with length(run) values.
struct Values {
  std::int64_t runs = 0;
  std::function<std::int64_t(std::int64_t run)> length;
  std::function<void(std::int64_t run, std::span<double> out)> read;
  double step = 0.0; ///< Distance between neighbouring possible values of integers, 0 for floats.
};

struct Block {
  std::int64_t count = 0, nans = 0, infinities = 0;
  double min = kInfinity, max = -kInfinity, sum = 0.0;
};

/// Calls body(block, values) for every block of runs, in parallel.
template <class Body>
void forBlocks(const Values& values, std::int64_t runsPerBlock, std::int64_t blocks, hbProgress& progress,
               const Body& body) {
  hb::parallelFor(blocks, [&](std::int64_t b) {
    std::vector<double> buffer;
    const std::int64_t last = std::min(values.runs, (b + 1) * runsPerBlock);
    for (std::int64_t run = b * runsPerBlock; run < last; ++run) {
      buffer.resize(std::size_t(values.length(run)));
      values.read(run, buffer);
      body(b, std::span<const double>(buffer));
    }
    progress.advance(1);
  });
}

hbHistogram calc(const Values& values, std::int64_t runsPerBlock, int bins, hbProgress& progress) {
  const std::int64_t blocks = (values.runs + runsPerBlock - 1) / runsPerBlock;
  progress.begin("histogram", 2 * blocks, "blocks");

  std::vector<Block> partial(static_cast<std::size_t>(blocks));
  forBlocks(values, runsPerBlock, blocks, progress, [&](std::int64_t b, std::span<const double> run) {
    Block& p = partial[std::size_t(b)];
    for (const double v : run) {
      if (std::isnan(v)) {
        ++p.nans;
      } else if (std::isinf(v)) {
        ++p.infinities;
      } else {
        ++p.count;
        p.min = std::min(p.min, v);
        p.max = std::max(p.max, v);
        p.sum += v;
      }
    }
  });
  hbHistogram h;
  h.min = kInfinity;
  h.max = -kInfinity;
  double sum = 0.0;
  for (const Block& p : partial) {
    h.count += p.count;
    h.nans += p.nans;
    h.infinities += p.infinities;
    h.min = std::min(h.min, p.min);
    h.max = std::max(h.max, p.max);
    sum += p.sum;
  }
  h.bins.resize(std::size_t(bins));
  if (h.count == 0) {
    h.min = h.max = h.mean = h.deviation = kNaN;
    return h;
  }
  h.mean = sum / double(h.count);

  // Halves, as the width of values near the largest double is not finite.
  const double halfWidth = 0.5 * h.max - 0.5 * h.min;
  const double steps = values.step > 0.0 ? std::nearbyint((h.max - h.min) / values.step) : kInfinity;
  h.exact = steps < double(kFineBins) || halfWidth == 0.0;
  const std::int64_t fineBins = halfWidth == 0.0 ? 1 : h.exact ? std::int64_t(steps) + 1 : kFineBins;
  h.fineStep = h.exact ? values.step : 2.0 * (halfWidth / double(kFineBins));
  const auto interval = [&](double v, std::int64_t intervals) {
    if (halfWidth == 0.0) return std::size_t{0};
    const double place = (0.5 * v - 0.5 * h.min) / halfWidth * double(intervals);
    return std::size_t(std::clamp(std::int64_t(place), std::int64_t{0}, intervals - 1));
  };

  struct Counts {
    std::vector<std::int64_t> bins, fine;
  };
  oneapi::tbb::enumerable_thread_specific<Counts> counts([&] {
    return Counts{std::vector<std::int64_t>(h.bins.size()), std::vector<std::int64_t>(std::size_t(fineBins))};
  });
  std::vector<double> squares(static_cast<std::size_t>(blocks));
  forBlocks(values, runsPerBlock, blocks, progress, [&](std::int64_t b, std::span<const double> run) {
    Counts& mine = counts.local();
    double& square = squares[std::size_t(b)];
    for (const double v : run) {
      if (!std::isfinite(v)) continue;
      square += (v - h.mean) * (v - h.mean);
      ++mine.bins[interval(v, bins)];
      const std::size_t fine = !h.exact        ? interval(v, kFineBins)
                               : fineBins == 1 ? 0
                                               : std::size_t(std::nearbyint((v - h.min) / values.step));
      ++mine.fine[fine];
    }
  });
  double square = 0.0;
  for (const double s : squares) square += s;
  h.deviation = std::sqrt(square / double(h.count));
  h.fine.resize(std::size_t(fineBins));
  for (const Counts& c : counts) {
    for (std::size_t i = 0; i < h.bins.size(); ++i) h.bins[i] += c.bins[i];
    for (std::size_t i = 0; i < h.fine.size(); ++i) h.fine[i] += c.fine[i];
  }
  return h;
}

void checkBins(int bins) {
  if (bins < 1) throw hbError(fmt::format("histogram: expected at least one bin, found {}", bins));
}

} // namespace

double hbHistogram::percentile(double p) const {
  if (count == 0) return kNaN;
  if (!(p > 0.0)) return min;
  if (p >= 1.0) return max;
  const double rank = std::max(1.0, std::ceil(p * double(count)));
  double below = 0.0;
  std::size_t i = 0;
  while (i + 1 < fine.size() && below + double(fine[i]) < rank) below += double(fine[i++]);
  const double at = exact ? double(i) : double(i) + (rank - below) / double(fine[i]);
  return std::clamp(min + at * fineStep, min, max);
}

double hbHistogram::otsuThreshold() const {
  if (count == 0) return kNaN;
  if (fine.size() == 1) return min;
  // In units of fine counts; moving and scaling the values does not move the best place.
  double total = 0.0;
  for (std::size_t i = 0; i < fine.size(); ++i) total += double(i) * double(fine[i]);
  double weight = 0.0, sum = 0.0, best = -1.0;
  std::size_t first = 0, last = 0;
  for (std::size_t i = 0; i + 1 < fine.size(); ++i) {
    weight += double(fine[i]);
    sum += double(i) * double(fine[i]);
    const double rest = double(count) - weight;
    if (weight == 0.0 || rest == 0.0) continue;
    const double apart = sum / weight - (total - sum) / rest;
    const double between = weight * rest * apart * apart;
    if (between > best) {
      best = between;
      first = last = i;
    } else if (between == best && last + 1 == i && fine[i] == 0) {
      last = i; // nothing lies between: the sums are the very same
    }
  }
  const double at = 0.5 * (double(first) + double(last)) + (exact ? 0.0 : 1.0);
  return std::clamp(min + at * fineStep, min, max);
}

std::vector<hbHistogram> hb::calcHistograms(const hbVolume& volume, int bins, hbProgress& progress) {
  checkBins(bins);
  const hbSize3 size = volume.geometry().size;
  const std::int64_t runsPerRow = (size.x + kBlock - 1) / kBlock;
  const bool integer = volume.type() != hbSampleType::float32 && volume.type() != hbSampleType::float64;
  std::vector<hbHistogram> result;
  for (int c = 0; c < volume.components(); ++c) {
    Values values;
    values.runs = runsPerRow * size.y * size.z;
    values.step = integer ? std::abs(volume.slope()) : 0.0;
    values.length = [&](std::int64_t run) { return std::min(kBlock, size.x - run % runsPerRow * kBlock); };
    values.read = [&, c](std::int64_t run, std::span<double> out) {
      const std::int64_t row = run / runsPerRow;
      volume.row(run % runsPerRow * kBlock, row % size.y, row / size.y, c, out);
    };
    result.push_back(calc(values, std::max<std::int64_t>(1, kBlock / size.x), bins, progress));
  }
  return result;
}

hbHistogram hb::calcHistogram(std::span<const float> values, int bins, hbProgress& progress) {
  checkBins(bins);
  const auto size = std::int64_t(values.size());
  Values runs;
  runs.runs = (size + kBlock - 1) / kBlock;
  runs.length = [&](std::int64_t run) { return std::min(kBlock, size - run * kBlock); };
  runs.read = [&](std::int64_t run, std::span<double> out) {
    std::copy_n(values.begin() + run * kBlock, out.size(), out.begin());
  };
  return calc(runs, 1, bins, progress);
}
