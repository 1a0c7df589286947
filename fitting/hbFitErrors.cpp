#include "fitting/hbFitErrors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

constexpr std::int64_t kMagnitudes = std::int64_t{1} << 20;

struct Plane {
  double squares[2] = {0.0, 0.0}, costs[2] = {0.0, 0.0}; ///< Fitted, held out.
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  std::vector<float> magnitudes;
  double squaresWithin = 0.0;
  std::int64_t within = 0;
};

} // namespace

hbFitErrors hbFitErrors::of(const hbFitSamples& samples, const hbSampleOperator& values,
                            std::span<const double> surpluses, const hbFitLoss& loss) {
  const std::int64_t oneIn = (samples.count() + kMagnitudes - 1) / kMagnitudes;
  std::vector<Plane> planes(static_cast<std::size_t>(samples.size().z));
  values.apply(surpluses, [&](std::int64_t z, std::span<double> own) {
    std::vector<float> data(own.size());
    samples.plane(z, data);
    Plane& plane = planes[std::size_t(z)];
    const std::int64_t first = z * samples.samplesOfPlane();
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::int64_t sample = first + std::int64_t(i);
      const double residual = own[i] - double(data[i]);
      const bool heldOut = hbFitSamples::isHeldOut(sample);
      plane.squares[heldOut ? 1 : 0] += residual * residual;
      plane.costs[heldOut ? 1 : 0] += loss.cost(residual);
      plane.lo = std::min(plane.lo, double(data[i]));
      plane.hi = std::max(plane.hi, double(data[i]));
      if (!heldOut && (loss.kind == hbFitLoss::Kind::none || std::abs(residual) <= loss.threshold)) {
        plane.squaresWithin += residual * residual;
        ++plane.within;
      }
      if (!heldOut && hbFitSamples::isOneIn(oneIn, sample)) plane.magnitudes.push_back(float(std::abs(residual)));
    }
  });
  hbFitErrors errors;
  Plane all;
  for (const Plane& plane : planes) {
    for (int k = 0; k < 2; ++k) {
      all.squares[k] += plane.squares[k];
      all.costs[k] += plane.costs[k];
    }
    all.squaresWithin += plane.squaresWithin;
    all.within += plane.within;
    all.lo = std::min(all.lo, plane.lo);
    all.hi = std::max(all.hi, plane.hi);
    errors.magnitudes.insert(errors.magnitudes.end(), plane.magnitudes.begin(), plane.magnitudes.end());
  }
  const double fitted = double(samples.fittedCount()), heldOut = double(samples.heldOutCount());
  errors.fitted = {std::sqrt(all.squares[0] / fitted), all.costs[0] / fitted};
  errors.heldOut = {std::sqrt(all.squares[1] / heldOut), all.costs[1] / heldOut};
  if (all.within > 0) errors.withinThreshold = std::sqrt(all.squaresWithin / double(all.within));
  errors.lo = all.lo;
  errors.hi = all.hi;
  return errors;
}

double hbFitErrors::bytes(const hbSize3& samples) {
  // Magnitudes of the planes and of all; a plane of samples for each thread.
  const double count = double(samples.x) * double(samples.y) * double(samples.z);
  return 2.0 * sizeof(float) * std::min(count, 1.1 * double(kMagnitudes)) +
         hbSampleOperator::planesAtOnce(samples) * double(samples.x) * double(samples.y) * sizeof(float);
}
