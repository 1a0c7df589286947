#include "fitting/hbCeresSolver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <numeric>
#include <vector>

#include <ceres/ceres.h>

#include "fitting/hbCeresLog.h"
#include "fitting/hbSurplusBlocks.h"
#include "volume/hbError.h"

namespace {

/// A robust loss bends single residuals, so each sample is one residual block; otherwise 2^3 are: the finest hats that
/// resolve the samples are wide enough for two of them, so hardly a zero is stored for it.
std::int64_t edgeOf(const hbFitLoss& loss) { return loss.kind == hbFitLoss::Kind::none ? 2 : 1; }

/// What all tiles share.
struct Data {
  Data(const hbLeastSquares& problem, double subtracted)
      : constant(subtracted), size(problem.samples.size()), blocks(problem.samples, problem.set, edgeOf(problem.loss)),
        values(std::size_t(problem.samples.count())),
        scale(1.0 / std::sqrt(double(std::max<std::int64_t>(problem.samples.fittedCount(), 1)))) {
    const std::int64_t plane = problem.samples.samplesOfPlane();
    for (std::int64_t z = 0; z < size.z; ++z)
      problem.samples.plane(z, std::span(values).subspan(std::size_t(z * plane), std::size_t(plane)));
  }

  double constant; ///< Less which samples are fitted.
  hbSize3 size;
  hbSurplusBlocks blocks;
  std::vector<float> values; ///< Of the samples.
  double scale;              ///< Of a residual, so that half the sum of squares is half their mean.
};

/// The residuals of a tile's samples.
class TileCost final : public ceres::CostFunction {
public:
  TileCost(const Data& data, const hbSize3& tile) : data_(data), tile_(tile) {
    set_num_residuals(int(data.blocks.samplesOf(tile).size()));
    std::size_t count = 0;
    data.blocks.forBlocks(tile, [&](const auto&, const auto&) { ++count; });
    mutable_parameter_block_sizes()->reserve(count);
    data.blocks.forBlocks(tile, [&](const hbSurplusBlocks::Group& group, const hbSize3&) {
      mutable_parameter_block_sizes()->push_back(group.surpluses());
    });
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const std::vector<hbSize3> samples = data_.blocks.samplesOf(tile_);
    for (std::size_t row = 0; row < samples.size(); ++row) {
      const hbSize3& s = samples[row];
      const std::int64_t sample = s.x + data_.size.x * (s.y + data_.size.y * s.z);
      residuals[row] = data_.constant - double(data_.values[std::size_t(sample)]);
    }
    std::array<double, hbSurplusBlocks::kMostSurpluses> weights;
    std::size_t block = 0;
    data_.blocks.forBlocks(tile_, [&](const hbSurplusBlocks::Group& group, const hbSize3& node) {
      const auto width = std::size_t(group.surpluses());
      for (std::size_t row = 0; row < samples.size(); ++row) {
        data_.blocks.weights(group, node, samples[row], weights);
        for (std::size_t i = 0; i < width; ++i) residuals[row] += weights[i] * parameters[block][i];
        if (jacobians != nullptr && jacobians[block] != nullptr)
          for (std::size_t i = 0; i < width; ++i) jacobians[block][row * width + i] = data_.scale * weights[i];
      }
      ++block;
    });
    for (std::size_t row = 0; row < samples.size(); ++row) residuals[row] *= data_.scale;
    return true;
  }

private:
  const Data& data_;
  hbSize3 tile_;
};

/// The smoothing of a block's surpluses.
class SmoothingCost final : public ceres::CostFunction {
public:
  SmoothingCost(const hbSurplusBlocks::Group& group, double smoothing) {
    for (int i = 0; i < group.surpluses(); ++i)
      roots_.push_back(std::sqrt(smoothing * hbLeastSquares::smoothingWeight(group.levelsOf(i))));
    set_num_residuals(group.surpluses());
    mutable_parameter_block_sizes()->push_back(group.surpluses());
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    for (std::size_t i = 0; i < roots_.size(); ++i) residuals[i] = roots_[i] * parameters[0][i];
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], roots_.size() * roots_.size(), 0.0);
    for (std::size_t i = 0; i < roots_.size(); ++i) jacobians[0][i * (roots_.size() + 1)] = roots_[i];
    return true;
  }

private:
  std::vector<double> roots_;
};

/// The problem in Ceres' terms. Its surpluses are in the order of blocks.
class Problem {
public:
  Problem(const hbLeastSquares& problem, double constant, std::span<double> surpluses, const hbProgress& progress)
      : data_(problem, constant), ceres_(options()) {
    // Halved squares as hbFitLoss has them, of residuals that are scaled.
    if (problem.loss.kind == hbFitLoss::Kind::huber)
      loss_ = std::make_unique<ceres::HuberLoss>(problem.loss.threshold * data_.scale);
    // Added in the order in which tiles name them: Ceres goes through a tile's pieces in this order, and so through
    // memory.
    for (const hbSurplusBlocks::Group& group : data_.blocks.groups())
      for (std::int64_t block = 0; block < group.blocks(); ++block)
        ceres_.AddParameterBlock(&surpluses[std::size_t(group.offset + block * group.surpluses())], group.surpluses());
    const hbSize3& tiles = data_.blocks.tiles();
    hbSize3 tile;
    for (tile.z = 0; tile.z < tiles.z && !progress.cancelled(); ++tile.z)
      for (tile.y = 0; tile.y < tiles.y; ++tile.y)
        for (tile.x = 0; tile.x < tiles.x; ++tile.x) add(tile, surpluses);
    if (problem.smoothing > 0.0)
      for (const hbSurplusBlocks::Group& group : data_.blocks.groups()) add(group, problem.smoothing, surpluses);
  }

  ceres::Problem& ceres() { return ceres_; }

private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  void add(const hbSize3& tile, std::span<double> surpluses) {
    const TileCost& cost = tiles_.emplace_back(data_, tile);
    if (cost.num_residuals() == 0) {
      tiles_.pop_back();
      return;
    }
    parameters_.clear();
    data_.blocks.forBlocks(tile, [&](const hbSurplusBlocks::Group& group, const hbSize3& node) {
      parameters_.push_back(&surpluses[std::size_t(group.begin(node))]);
    });
    ceres_.AddResidualBlock(&tiles_.back(), loss_.get(), parameters_.data(), int(parameters_.size()));
  }

  void add(const hbSurplusBlocks::Group& group, double smoothing, std::span<double> surpluses) {
    if (group.levels == glm::ivec3(1) && group.levelsOf(group.surpluses() - 1) == glm::ivec3(0)) return;
    smoothing_.emplace_back(group, smoothing);
    for (std::int64_t block = 0; block < group.blocks(); ++block) {
      double* const first = &surpluses[std::size_t(group.offset + block * group.surpluses())];
      ceres_.AddResidualBlock(&smoothing_.back(), nullptr, &first, 1);
    }
  }

  Data data_;
  std::unique_ptr<ceres::LossFunction> loss_; ///< None: squares.
  std::deque<TileCost> tiles_;
  std::deque<SmoothingCost> smoothing_;
  std::vector<double*> parameters_; ///< Of the tile that is added.
  ceres::Problem ceres_;            ///< Looks at the costs to its end.
};

/// Counts, and stops the solver when it should stop.
class Callback final : public ceres::IterationCallback {
public:
  Callback(hbProgress& progress, hbLeastSquares::Solution& solution) : progress_(progress), solution_(solution) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    solution_.iterations += summary.linear_solver_iterations;
    try {
      progress_.advance(summary.linear_solver_iterations);
    } catch (const hbCancelled&) {
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY; // with what it has; SOLVER_ABORT would drop it
    }
    return ceres::SOLVER_CONTINUE;
  }

private:
  hbProgress& progress_;
  hbLeastSquares::Solution& solution_;
};

ceres::Solver::Options optionsOf(double tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::CGNR;
  options.preconditioner_type = ceres::JACOBI;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  hb::silenceCeres();
  options.max_num_iterations = 500;
  options.max_linear_solver_iterations = 1000;
  // Wide enough for a quadratic problem to be solved at once, narrow enough for the blocks of the diagonal to be
  // factorised where samples do not determine them.
  options.initial_trust_region_radius = 1e12;
  // A linear problem ends when the i-th step gains less than eta / i of what all steps gained. What this leaves, the
  // next rounds gain, until it is less than the tolerance's share, or than what rounding does to the objective.
  options.eta = std::clamp(tolerance * tolerance, 1e-10, 1e-2);
  options.function_tolerance = std::max(tolerance * tolerance, 1e-15);
  options.gradient_tolerance = 0.0;
  options.parameter_tolerance = 1e-15;
  return options;
}

} // namespace

double hbCeresSolver::bytes(const hbLeastSquares& problem) {
  const hbSurplusBlocks blocks(problem.samples, problem.set, edgeOf(problem.loss));
  const hbSurplusBlocks::Counts counts = blocks.counts();
  double smoothing = 0.0;
  if (problem.smoothing > 0.0)
    for (const hbSurplusBlocks::Group& group : blocks.groups())
      smoothing += double(group.blocks()) * group.surpluses() * group.surpluses();
  // Of a piece: its place in the matrix (8 bytes) and its parts of the residual block (8), the cost (4) and the
  // Jacobian's layout (4). The others as measured, with their allocation, residuals and vectors.
  constexpr double kPiece = 24.0, kTile = 256.0, kBlock = 640.0, kSample = 48.0, kSurplus = 160.0, kAlways = 0x1p20;
  return 8.0 * (counts.values + smoothing) + kPiece * counts.pieces + kTile * counts.tiles + kBlock * counts.blocks +
         kSample * double(problem.samples.count()) + kSurplus * double(problem.set.storedValues()) + kAlways;
}

hbLeastSquares::Solution hbCeresSolver::solve(const hbLeastSquares& problem, std::span<const double> start,
                                              double tolerance, hbProgress& progress) {
  hbLeastSquares::Solution solution;
  solution.surpluses.assign(start.begin(), start.end());
  // The corners' hats add up to 1: without what they have in common, a large constant takes no digits.
  const std::span<double> corners =
      std::span(solution.surpluses).first(std::size_t(problem.set.subspaces().front().count()));
  const double constant = std::accumulate(corners.begin(), corners.end(), 0.0) / double(corners.size());
  const std::vector<std::int64_t> order = hbSurplusBlocks(problem.samples, problem.set, 1).order();
  std::vector<double> surpluses(start.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    surpluses[std::size_t(order[i])] = start[i] - (i < corners.size() ? constant : 0.0);
  Problem inBlocks(problem, constant, surpluses, progress);
  solution.interrupted = progress.cancelled();
  if (solution.interrupted) return solution;

  Callback callback(progress, solution);
  ceres::Solver::Options options = optionsOf(tolerance);
  options.callbacks.push_back(&callback);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &inBlocks.ceres(), &summary);
  solution.rounds = int(summary.iterations.size()) - 1;
  solution.interrupted = progress.cancelled();
  solution.converged = !solution.interrupted && summary.termination_type == ceres::CONVERGENCE;
  for (std::size_t i = 0; i < order.size(); ++i) solution.surpluses[i] = surpluses[std::size_t(order[i])];
  for (double& corner : corners) corner += constant;
  return solution;
}
