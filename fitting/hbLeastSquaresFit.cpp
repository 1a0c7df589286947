#include "fitting/hbLeastSquaresFit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "volume/hbError.h"

namespace {

constexpr double kTolerance = 1e-3;
/// For fits that are steps on the way: an RMSE that is 1 % off tells as well which weight is better.
constexpr double kRoughly = 1e-1, kNearly = 1e-2;

/// A smoothing that changes nothing but what samples leave open: on the finest subspaces, where smoothing weighs 4^|l|
/// times as much as the residual, it takes 4^-8 of an amplitude.
double leastSmoothing(const hbIndexSet& set) {
  int finest = 0;
  for (const hbSubspace& s : set.subspaces()) finest = std::max(finest, s.levels.x + s.levels.y + s.levels.z);
  return std::ldexp(1.0, -2 * (finest + 8));
}

/// Where more than half of the residuals are 0 their median says nothing.
double thresholdOf(hbFitErrors errors) {
  return std::max(hbFitLoss::thresholdOf(errors.magnitudes), (errors.hi - errors.lo) * 0x1p-12);
}

} // namespace

class hbLeastSquaresFit::Search {
public:
  Search(const hbFitSamples& samples, const hbIndexSet& set, const hbSampleOperator& values,
         std::span<const double> start, const Solve& solve, hbProgress& progress)
      : samples_(samples), set_(set), values_(values), solve_(solve), progress_(progress) {
    result_.solution.surpluses.assign(start.begin(), start.end());
  }

  Result& result() { return result_; }
  bool interrupted() const { return result_.solution.interrupted; }

  /// Goes on from where it is.
  void fit(double tolerance) {
    const hbLeastSquares problem{samples_, set_, result_.loss, result_.smoothing};
    hbLeastSquares::Solution next = solve_(problem, result_.solution.surpluses, tolerance, progress_);
    next.iterations += result_.solution.iterations;
    next.rounds += result_.solution.rounds;
    result_.solution = std::move(next);
  }

  hbFitErrors errors() const { return hbFitErrors::of(samples_, values_, result_.solution.surpluses, result_.loss); }

  void findThreshold() {
    fit(kRoughly);
    result_.loss = {hbFitLoss::Kind::huber, thresholdOf(errors())};
  }

  void findSmoothing() {
    constexpr double kStep = 16.0, kMost = 1.0;
    // Below what matters costs are alike but for the solver's tolerance: only a clear rise ends the search.
    constexpr double kRise = 1.02;
    Result best = result_;
    double least = std::numeric_limits<double>::infinity();
    while (true) {
      fit(kNearly);
      const double cost = errors().heldOut.cost;
      if (cost < least) {
        least = cost;
        best = result_;
      }
      if (interrupted() || !(cost <= kRise * least) || result_.smoothing * kStep > kMost) break;
      result_.smoothing *= kStep;
    }
    best.solution.iterations = result_.solution.iterations;
    best.solution.rounds = result_.solution.rounds;
    best.solution.interrupted = interrupted();
    result_ = std::move(best);
  }

private:
  const hbFitSamples& samples_;
  const hbIndexSet& set_;
  const hbSampleOperator& values_;
  const Solve& solve_;
  hbProgress& progress_;
  Result result_;
};

hbLeastSquaresFit::Result hbLeastSquaresFit::run(const hbFitSamples& samples, const hbIndexSet& set,
                                                 const hbSampleOperator& values, std::span<const double> start,
                                                 const Solve& solve, hbProgress& progress) const {
  if (smoothing == 0.0) {
    const int axis = hbLeastSquares{samples, set, {}, 0.0}.undeterminedAxis();
    if (axis >= 0)
      throw hbError(
          fmt::format("smoothing: expected more than 0, found 0: along {} the grid has more nodes than its {} "
                      "samples determine",
                      "xyz"[axis], samples.size()[axis]));
  }
  Search search(samples, set, values, start, solve, progress);
  Result& result = search.result();
  result.smoothing = smoothing.value_or(leastSmoothing(set));
  if (loss == hbFitLoss::Kind::huber) {
    if (threshold)
      result.loss = {loss, *threshold};
    else
      search.findThreshold();
  }
  if (!smoothing && !search.interrupted()) search.findSmoothing();
  if (!search.interrupted()) search.fit(kTolerance);
  return std::move(result);
}
