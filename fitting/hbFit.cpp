#include "fitting/hbFit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "fitting/hbCeresSolver.h"
#include "fitting/hbConjugateGradientSolver.h"
#include "fitting/hbFitErrors.h"
#include "fitting/hbFitSamples.h"
#include "fitting/hbLeastSquaresFit.h"
#include "fitting/hbOpticom.h"
#include "fitting/hbSampleOperator.h"
#include "volume/hbError.h"

namespace {

using Surpluses = std::vector<double>;

/// To multiples of `step`, and to floats, as they are stored.
Surpluses rounded(const Surpluses& surpluses, double step) {
  Surpluses stored(surpluses.size());
  std::transform(surpluses.begin(), surpluses.end(), stored.begin(), [step](double surplus) {
    return double(float(step > 0.0 ? step * std::nearbyint(surplus / step) : surplus));
  });
  return stored;
}

/// From field values to data values.
void toData(hbFitReport& report, double scale) {
  report.loss.threshold *= scale;
  for (hbFitReport::Errors* errors :
       {&report.fitted, &report.heldOutErrors, &report.interpolationFitted, &report.interpolationHeldOutErrors}) {
    errors->rmse *= scale;
    errors->cost *= scale * scale;
  }
}

void refuseBeyond(std::uint64_t limit, double bytes) {
  if (bytes > double(limit))
    throw hbError(fmt::format("fit: needs about {:.3g} MB, more than the memory limit of {:.3g} MB", bytes / 0x1p20,
                              double(limit) / 0x1p20));
}

/// Fits one component.
class ComponentFit {
public:
  ComponentFit(const hbFit& how, const hbField& source, const hbSparseGrid& grid, int component, hbProgress& progress)
      : how_(how), set_(grid.indexSet()), samples_(source, grid, component),
        values_(set_, {samples_.coordinates(0), samples_.coordinates(1), samples_.coordinates(2)}), grid_(grid),
        component_(component), interpolation_(grid.surpluses(component).begin(), grid.surpluses(component).end()),
        scale_(grid.valueMap().scale), progress_(progress) {}

  /// The surpluses, those of interpolation where the fit is no better.
  std::pair<Surpluses, hbFitReport> run() {
    const auto start = std::chrono::steady_clock::now();
    report_.samples = samples_.fittedCount();
    report_.heldOut = samples_.heldOutCount();
    const Surpluses exact = how_.method == hbFit::Method::opticom ? opticom() : leastSquares();
    if (report_.interrupted && !how_.keepBest) throw hbCancelled();
    const bool begun = !report_.interrupted || report_.iterations > 0;
    Surpluses fitted = begun ? shortened(exact, errorsOf(exact).withinThreshold) : interpolation_;
    const hbFitErrors errors = errorsOf(fitted), interpolated = errorsOf(interpolation_);
    report_.fitted = errors.fitted;
    report_.heldOutErrors = errors.heldOut;
    report_.interpolationFitted = interpolated.fitted;
    report_.interpolationHeldOutErrors = interpolated.heldOut;
    // A robust loss may cost less for leaving out what is hard to follow, and no outliers: that shows in the RMSE.
    report_.improved =
        errors.heldOut.cost < interpolated.heldOut.cost && errors.heldOut.rmse < interpolated.heldOut.rmse;
    toData(report_, scale_);
    report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return {report_.improved ? std::move(fitted) : std::move(interpolation_), report_};
  }

private:
  hbFitErrors errorsOf(const Surpluses& surpluses) const {
    return hbFitErrors::of(samples_, values_, surpluses, report_.loss);
  }

  /// Rounded to multiples of the greatest power of two that hardly shows: zeros at the end of surpluses pack, digits
  /// that say nothing do not.
  Surpluses shortened(const Surpluses& exact, double residual) const {
    const double most = hbFit::kRounding * residual;
    double step = std::exp2(std::floor(std::log2(residual)));
    for (int halving = 0; halving < 16 && residual > 0.0; ++halving, step *= 0.5) {
      Surpluses stored = rounded(exact, step), difference(exact.size());
      std::transform(stored.begin(), stored.end(), exact.begin(), difference.begin(), std::minus<>());
      if (values_.rootMeanSquare(difference) <= most) return stored;
    }
    return rounded(exact, 0.0);
  }

  Surpluses opticom() {
    hbOpticom fit{grid_, component_, samples_, {how_.loss, how_.threshold.value_or(0.0) / scale_}};
    const hbOpticom::Solution solution = fit.solve(progress_);
    report_.method = "opticom";
    report_.solver = "ceres";
    report_.loss = solution.loss;
    report_.samples = solution.samples;
    report_.unknowns = std::int64_t(solution.coefficients.size());
    report_.iterations = solution.iterations;
    report_.rounds = solution.rounds;
    report_.converged = solution.converged;
    report_.interrupted = solution.interrupted;
    report_.condition = solution.condition;
    return hbOpticom::surpluses(grid_, component_, solution.coefficients);
  }

  bool takesCeres() const {
    if (how_.solver == hbFit::Solver::conjugateGradient) return false;
    const double need = hbCeresSolver::bytes({samples_, set_, {how_.loss, 1.0}, 1.0});
    const double all = need + how_.bytes(set_, samples_.size());
    if (how_.solver == hbFit::Solver::automatic) return need <= hbFit::kCeresBytes && all <= double(how_.memoryLimit);
    refuseBeyond(how_.memoryLimit, all);
    return true;
  }

  Surpluses leastSquares() {
    hbLeastSquaresFit fit{how_.loss, {}, how_.smoothing};
    if (how_.threshold) fit.threshold = *how_.threshold / scale_;
    const bool ceres = takesCeres();
    const hbConjugateGradientSolver own(samples_, set_);
    const auto solve = [&](const hbLeastSquares& problem, std::span<const double> start, double tolerance,
                           hbProgress& progress) {
      return ceres ? hbCeresSolver::solve(problem, start, tolerance, progress)
                   : own.solve(problem, start, {tolerance}, progress);
    };
    // How many it takes shows on the way; with these the bar is about right where the samples determine the grid.
    constexpr std::int64_t kPlainPasses = 60, kRobustPasses = 150;
    progress_.begin("fitting", how_.loss == hbFitLoss::Kind::none ? kPlainPasses : kRobustPasses, "passes");
    hbLeastSquaresFit::Result result = fit.run(samples_, set_, values_, interpolation_, solve, progress_);
    report_.method = "least-squares";
    report_.solver = ceres ? "ceres" : "conjugate-gradient";
    report_.loss = result.loss;
    report_.smoothing = result.smoothing;
    report_.unknowns = set_.storedValues();
    report_.iterations = result.solution.iterations;
    report_.rounds = result.solution.rounds;
    report_.converged = result.solution.converged;
    report_.interrupted = result.solution.interrupted;
    report_.condition = result.solution.condition;
    // Ceres does not tell; the problem is the same.
    if (ceres && !report_.interrupted)
      report_.condition =
          own.solve({samples_, set_, result.loss, result.smoothing}, interpolation_, {1e-2}, progress_).condition;
    return std::move(result.solution.surpluses);
  }

  const hbFit& how_;
  const hbIndexSet& set_;
  hbFitSamples samples_;
  hbSampleOperator values_;
  const hbSparseGrid& grid_;
  int component_;
  Surpluses interpolation_;
  double scale_;
  hbProgress& progress_;
  hbFitReport report_;
};

} // namespace

void hbFit::check(const hbSize3& samples) const {
  const double count = double(samples.x) * double(samples.y) * double(samples.z);
  if (count < double(kFewestSamples))
    throw hbError(fmt::format("fit: expected {} samples at least, some of which can be held out, found {}",
                              kFewestSamples, count));
  if (count > double(kMostSamples))
    throw hbError(fmt::format("fit: expected {} samples at most, found {:.4g}: each is looked at a hundred times",
                              kMostSamples, count));
  if (threshold && !(*threshold > 0.0 && std::isfinite(*threshold)))
    throw hbError(fmt::format("loss threshold: expected a number above 0, found {}", *threshold));
  if (smoothing && !(*smoothing >= 0.0 && std::isfinite(*smoothing)))
    throw hbError(fmt::format("smoothing: expected a number from 0 on, found {}", *smoothing));
}

double hbFit::bytes(const hbIndexSet& set, const hbSize3& samples) const {
  const double solving =
      method == Method::opticom
          ? hbOpticom::bytes(set, std::min(hbOpticom::kMostSamples, samples.x * samples.y * samples.z)) +
                hbSampleOperator::bytes(set, samples)
          : hbConjugateGradientSolver::bytes(set, samples, loss);
  // The surpluses found, those rounded, those of interpolation, and the best so far; what errors are told from.
  return 5.0 * 8.0 * double(set.storedValues()) + hbFitErrors::bytes(samples) + solving;
}

hbFit::Result hbFit::run(const hbField& source, const hbSparseGrid& interpolated, hbProgress& progress) const {
  check(interpolated.geometry().size);
  refuseBeyond(memoryLimit, bytes(interpolated.indexSet(), interpolated.geometry().size));
  std::vector<hbFitReport> reports;
  std::vector<std::vector<float>> surpluses;
  for (int c = 0; c < interpolated.components(); ++c) {
    const auto [fitted, report] = ComponentFit(*this, source, interpolated, c, progress).run();
    surpluses.emplace_back(fitted.begin(), fitted.end());
    reports.push_back(report);
  }
  return {hbSparseGrid::fromSurpluses(interpolated.frame(), interpolated.indexSet(), std::move(surpluses)),
          std::move(reports)};
}
