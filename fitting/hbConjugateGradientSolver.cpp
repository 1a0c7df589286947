#include "fitting/hbConjugateGradientSolver.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "fitting/hbConjugateGradient.h"
#include "fitting/hbPrewavelet.h"
#include "volume/hbError.h"

namespace {

/// What the diagonal of H is made of, for one prewavelet of an axis; for products of them they are multiplied.
struct AxisNorms {
  double square = 1.0; ///< Its mean square over the samples.
  double energy = 1.0; ///< The weighted sum of its squared surpluses, those of level 0 with the weight 1.
  double ends = 1.0;   ///< The sum of the squared ones of level 0.
};

AxisNorms normsOf(const hbPrewavelet& wavelet, std::span<const double> coordinates) {
  const double nodes = std::ldexp(1.0, wavelet.level);
  AxisNorms norms{0.0, 0.0, 0.0};
  const auto begin = std::lower_bound(coordinates.begin(), coordinates.end(), double(wavelet.first - 1) / nodes);
  const auto end = std::upper_bound(begin, coordinates.end(), double(wavelet.first + wavelet.count) / nodes);
  for (auto x = begin; x != end; ++x) norms.square += wavelet.value(*x) * wavelet.value(*x);
  norms.square /= double(coordinates.size());

  // The squared slope is that of the straight line between the ends and that of the rest, which is orthogonal to it.
  const double left = wavelet.value(0.0), right = wavelet.value(1.0);
  for (std::int64_t node = std::max<std::int64_t>(wavelet.first - 1, 0);
       node < std::min<std::int64_t>(wavelet.first + wavelet.count, std::int64_t(nodes)); ++node) {
    const double rise = wavelet.value(double(node + 1) / nodes) - wavelet.value(double(node) / nodes);
    norms.energy += rise * rise * nodes;
  }
  norms.ends = left * left + right * right;
  norms.energy += norms.ends - (right - left) * (right - left);
  return norms;
}

/// By level and place.
std::vector<std::vector<AxisNorms>> axisNorms(const hbIndexSet& set, int axis, std::span<const double> coordinates) {
  const bool flat = set.flat()[axis];
  std::vector<std::vector<AxisNorms>> norms(std::size_t(set.finest()[axis] + 1));
  for (int l = 0; l <= set.finest()[axis]; ++l)
    for (std::int64_t k = 0; k < hbIndexSet::axisNodes(flat, l); ++k)
      norms[std::size_t(l)].push_back(flat ? AxisNorms{} : normsOf(hbPrewavelet::at(false, l, k), coordinates));
  return norms;
}

} // namespace

/// One round: the weights are given by the residuals of what it begins at, the problem is a quadratic one.
class hbConjugateGradientSolver::Round {
public:
  Round(const hbConjugateGradientSolver& solver, const hbLeastSquares& problem, hbProgress& progress)
      : solver_(solver), problem_(problem), progress_(progress), samples_(solver.samples_) {
    if (problem.loss.kind != hbFitLoss::Kind::none) weights_.resize(std::size_t(samples_.count()));
  }

  /// Weighs the samples, and finds the objective and its steepest descent (for prewavelets) at these surpluses; false:
  /// interrupted.
  bool begin(std::span<const double> surpluses) {
    const auto planes = std::size_t(samples_.size().z);
    std::vector<double> costs(planes), weights(planes);
    descent_.resize(surpluses.size());
    solver_.operator_.applyBoth(
        surpluses,
        [&](std::int64_t z, std::span<double> values) {
          std::vector<float> plane(values.size());
          samples_.plane(z, plane);
          const std::int64_t first = z * samples_.samplesOfPlane();
          for (std::size_t i = 0; i < values.size(); ++i) {
            const bool heldOut = hbFitSamples::isHeldOut(first + std::int64_t(i));
            const double residual = values[i] - double(plane[i]);
            const double weight = heldOut ? 0.0 : problem_.loss.weight(residual);
            if (!heldOut) costs[std::size_t(z)] += problem_.loss.cost(residual);
            weights[std::size_t(z)] += weight;
            if (!weights_.empty()) weights_[std::size_t(first) + i] = float(weight);
            values[i] = -weight * residual;
          }
        },
        descent_, progress_);
    if (progress_.cancelled()) return false;
    const double count = double(samples_.fittedCount());
    const auto sum = [](const std::vector<double>& parts) { return std::accumulate(parts.begin(), parts.end(), 0.0); };
    objective_ = sum(costs) / count;
    meanWeight_ = sum(weights) / count;
    for (std::size_t i = 0; i < surpluses.size(); ++i) {
      const double pull = problem_.smoothing * solver_.smoothing_[i] * surpluses[i];
      objective_ += 0.5 * pull * surpluses[i];
      descent_[i] = descent_[i] / count - pull;
    }
    hb::prewaveletsToSurplusesTransposed(solver_.set_, descent_);
    return true;
  }

  double objective() const { return objective_; }
  double meanWeight() const { return meanWeight_; }
  std::span<const double> descent() const { return descent_; }

  /// out = H in; false: interrupted.
  bool apply(std::span<const double> in, std::span<double> out) const {
    std::vector<double> surpluses(in.begin(), in.end());
    hb::prewaveletsToSurpluses(solver_.set_, surpluses);
    solver_.operator_.applyBoth(
        surpluses,
        [&](std::int64_t z, std::span<double> values) {
          const std::int64_t first = z * samples_.samplesOfPlane();
          if (weights_.empty()) {
            for (std::size_t i = 0; i < values.size(); ++i)
              if (hbFitSamples::isHeldOut(first + std::int64_t(i))) values[i] = 0.0;
          } else {
            for (std::size_t i = 0; i < values.size(); ++i) values[i] *= double(weights_[std::size_t(first) + i]);
          }
        },
        out, progress_);
    if (progress_.cancelled()) return false;
    const double share = 1.0 / double(samples_.fittedCount());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = share * out[i] + problem_.smoothing * solver_.smoothing_[i] * surpluses[i];
    hb::prewaveletsToSurplusesTransposed(solver_.set_, out);
    count();
    return true;
  }

private:
  /// Whoever has to stop asks for cancelled().
  void count() const {
    try {
      progress_.advance(1);
    } catch (const hbCancelled&) {
    }
  }

  const hbConjugateGradientSolver& solver_;
  const hbLeastSquares& problem_;
  hbProgress& progress_;
  const hbFitSamples& samples_;
  std::vector<float> weights_; ///< Of the samples; none: 1, and 0 where held out.
  std::vector<double> descent_;
  double objective_ = 0.0, meanWeight_ = 1.0;
};

hbConjugateGradientSolver::hbConjugateGradientSolver(const hbFitSamples& samples, const hbIndexSet& set)
    : samples_(samples), set_(set),
      operator_(set, {samples.coordinates(0), samples.coordinates(1), samples.coordinates(2)}) {
  std::array<std::vector<std::vector<AxisNorms>>, 3> norms;
  for (int d = 0; d < 3; ++d) norms[std::size_t(d)] = axisNorms(set, d, samples.coordinates(d));
  for (const hbSubspace& s : set.subspaces()) {
    smoothing_.insert(smoothing_.end(), std::size_t(s.count()), hbLeastSquares::smoothingWeight(s.levels));
    const auto of = [&](int axis, std::int64_t k) -> const AxisNorms& {
      return norms[std::size_t(axis)][std::size_t(s.levels[axis])][std::size_t(k)];
    };
    for (std::int64_t k = 0; k < s.nodes.z; ++k)
      for (std::int64_t j = 0; j < s.nodes.y; ++j)
        for (std::int64_t i = 0; i < s.nodes.x; ++i) {
          const AxisNorms &x = of(0, i), &y = of(1, j), &z = of(2, k);
          norm_.push_back(x.square * y.square * z.square);
          energy_.push_back(x.energy * y.energy * z.energy - x.ends * y.ends * z.ends);
        }
  }
}

std::vector<double> hbConjugateGradientSolver::diagonalOf(double meanWeight, double smoothing) const {
  std::vector<double> diagonal(norm_.size());
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    diagonal[i] = meanWeight * norm_[i] + smoothing * energy_[i];
    if (!(diagonal[i] > 0.0)) diagonal[i] = 1.0; // no sample sees it, and nothing changes it
  }
  return diagonal;
}

hbLeastSquares::Solution hbConjugateGradientSolver::solve(const hbLeastSquares& problem, std::span<const double> start,
                                                          const Settings& settings, hbProgress& progress) const {
  assert(start.size() == norm_.size());
  hbLeastSquares::Solution solution;
  solution.surpluses.assign(start.begin(), start.end());
  Round round(*this, problem, progress);
  const bool robust = problem.loss.kind != hbFitLoss::Kind::none;
  double before = std::numeric_limits<double>::infinity();
  while (solution.rounds < (robust ? settings.mostRounds : 1)) {
    if (!round.begin(solution.surpluses)) {
      solution.interrupted = true;
      break;
    }
    const double fall = before - round.objective();
    if (solution.rounds > 0 && fall <= settings.tolerance * settings.tolerance * round.objective()) {
      solution.converged = true;
      break;
    }
    before = round.objective();
    hbConjugateGradient::Result step = hbConjugateGradient::solve(
        [&](std::span<const double> in, std::span<double> out) { return round.apply(in, out); },
        diagonalOf(round.meanWeight(), problem.smoothing), round.descent(), {before, settings.tolerance});
    hb::prewaveletsToSurpluses(set_, step.x);
    for (std::size_t i = 0; i < step.x.size(); ++i) solution.surpluses[i] += step.x[i];
    ++solution.rounds;
    solution.iterations += step.iterations;
    solution.condition = std::fmax(solution.condition, step.condition);
    if (!robust) solution.converged = step.converged;
    if (step.interrupted) {
      solution.interrupted = true;
      break;
    }
  }
  return solution;
}

void hbConjugateGradientSolver::apply(const hbLeastSquares& problem, std::span<const double> in,
                                      std::span<double> out) const {
  const hbLeastSquares plain{problem.samples, problem.set, {}, problem.smoothing};
  Round(*this, plain, hbProgress::none()).apply(in, out);
}

double hbConjugateGradientSolver::bytes(const hbIndexSet& set, const hbSize3& samples, hbFitLoss::Kind loss) {
  const double count = double(samples.x) * double(samples.y) * double(samples.z);
  constexpr double kVectors =
      14.0; // of 8 bytes a node: solution, descent, five of the method, three of the diagonal, ...
  return hbSampleOperator::bytes(set, samples) + kVectors * 8.0 * double(set.storedValues()) +
         (loss == hbFitLoss::Kind::none ? 0.0 : 4.0 * count);
}
