#include "fitting/hbOpticom.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <random>

#include <Eigen/Dense>
#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "fitting/hbCeresLog.h"
#include "sparsegrid/hbComponentNodes.h"
#include "volume/hbError.h"
#include "volume/hbParallel.h"

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;
using Grids = std::vector<hbIndexSet::ComponentGrid>;

/// Rows that are worked on at a time: what is summed up in which order must not depend on the number of threads.
constexpr Eigen::Index kRows = 8192;

void forEachBlock(Eigen::Index rows, const std::function<void(Eigen::Index first, Eigen::Index count)>& body) {
  hb::parallelFor((rows + kRows - 1) / kRows, [&](std::int64_t block) {
    const Eigen::Index first = block * kRows;
    body(first, std::min(kRows, rows - first));
  });
}

/// The samples used, as places among all of them, increasing: one in each of `most` equal parts, unless it is held out.
std::vector<std::int64_t> chosenSamples(const hbFitSamples& samples, std::int64_t most) {
  const std::int64_t all = samples.count(),
                     parts = std::clamp<std::int64_t>(most, 1, std::min(all, hbOpticom::kMostSamples));
  std::mt19937_64 random; // whose numbers are the same everywhere
  std::vector<std::int64_t> chosen;
  for (std::int64_t i = 0; i < parts; ++i) {
    const std::int64_t first = i * all / parts, next = (i + 1) * all / parts;
    const std::int64_t sample = first + std::int64_t(random() % std::uint64_t(next - first));
    if (!hbFitSamples::isHeldOut(sample)) chosen.push_back(sample);
  }
  return chosen;
}

/// Of the samples used.
Vector valuesOf(const hbFitSamples& samples, const std::vector<std::int64_t>& chosen) {
  Vector values(Eigen::Index(chosen.size()));
  hb::parallelFor(samples.size().z, [&](std::int64_t z) {
    const std::int64_t start = z * samples.samplesOfPlane();
    auto next = std::lower_bound(chosen.begin(), chosen.end(), start);
    const auto end = std::lower_bound(next, chosen.end(), start + samples.samplesOfPlane());
    if (next == end) return;
    std::vector<float> plane(std::size_t(samples.samplesOfPlane()));
    samples.plane(z, plane);
    for (; next != end; ++next) values[next - chosen.begin()] = double(plane[std::size_t(*next - start)]);
  });
  return values;
}

/// The cell of a component grid's axis that a sample is in, and where.
struct Cell {
  std::int64_t index = 0, step = 0; ///< Lower node, and from there to the upper one: 0 on a flat axis.
  double t = 0.0;
};

std::vector<Cell> cellsOf(std::span<const double> coordinates, std::int64_t nodes) {
  std::vector<Cell> cells(coordinates.size());
  for (std::size_t i = 0; i < cells.size() && nodes > 1; ++i) {
    const double place = coordinates[i] * double(nodes - 1);
    const std::int64_t index = std::min(std::int64_t(place), nodes - 2);
    cells[i] = {index, 1, place - double(index)};
  }
  return cells;
}

double lerp(double a, double b, double t) { return a + t * (b - a); }

/// The interpolant of one component grid at the samples used.
void interpolate(const hbOpticom& problem, const hbIndexSet::ComponentGrid& grid, std::span<const double> nodal,
                 const std::vector<std::int64_t>& chosen, Matrix::ColXpr out) {
  const hbSize3 nodes = grid.nodes, size = problem.samples.size();
  std::vector<double> values(std::size_t(nodes.x * nodes.y * nodes.z));
  hb::copyComponentNodes(problem.grid.indexSet(), nodal, grid.levels, values.data());
  std::array<std::vector<Cell>, 3> cells;
  for (int d = 0; d < 3; ++d) cells[std::size_t(d)] = cellsOf(problem.samples.coordinates(d), nodes[d]);
  forEachBlock(out.size(), [&](Eigen::Index first, Eigen::Index count) {
    for (Eigen::Index j = first; j < first + count; ++j) {
      const std::int64_t sample = chosen[std::size_t(j)];
      const Cell& x = cells[0][std::size_t(sample % size.x)];
      const Cell& y = cells[1][std::size_t(sample / size.x % size.y)];
      const Cell& z = cells[2][std::size_t(sample / (size.x * size.y))];
      const double* corner = values.data() + x.index + nodes.x * (y.index + nodes.y * z.index);
      const std::int64_t dy = nodes.x * y.step, dz = nodes.x * nodes.y * z.step;
      const auto along = [&](std::int64_t at) { return lerp(corner[at], corner[at + x.step], x.t); };
      out[j] = lerp(lerp(along(0), along(dy), y.t), lerp(along(dz), along(dy + dz), y.t), z.t);
    }
  });
}

/// The upper triangle of the QR decomposition of `rows`, K x K: that of each block, then of all these.
/// Throws hbCancelled.
Matrix triangleOf(const Matrix& rows, hbProgress& progress) {
  const Eigen::Index columns = rows.cols(), blocks = (rows.rows() + kRows - 1) / kRows;
  Eigen::MatrixXd triangles = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(blocks, 1) * columns, columns);
  const auto triangle = [&](Eigen::MatrixXd block) -> Eigen::MatrixXd {
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(block);
    return qr.matrixQR().topRows(std::min(block.rows(), columns)).triangularView<Eigen::Upper>();
  };
  progress.begin("decomposing", blocks, "blocks of samples");
  forEachBlock(rows.rows(), [&](Eigen::Index first, Eigen::Index count) {
    const Eigen::MatrixXd part = triangle(rows.middleRows(first, count));
    triangles.middleRows(first / kRows * columns, part.rows()) = part;
    progress.advance(1);
  });
  return triangle(triangles);
}

/// The greatest by the least singular value of the triangle with columns scaled to one norm.
double conditionOf(Matrix triangle) {
  for (Eigen::Index l = 0; l < triangle.cols(); ++l) {
    const double norm = triangle.col(l).norm();
    if (!(norm > 0.0)) return std::numeric_limits<double>::infinity();
    triangle.col(l) /= norm;
  }
  const Vector values = Eigen::JacobiSVD<Eigen::MatrixXd>(triangle).singularValues();
  return values[0] / values[values.size() - 1];
}

/// The residual of one sample: that of interpolation, and its change with the unknowns.
class SampleCost final : public ceres::CostFunction {
public:
  SampleCost(double start, const double* row, int unknowns) : start_(start), row_(row) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int unknowns = parameter_block_sizes()[0];
    using Row = Eigen::Map<const Vector>;
    residuals[0] = start_ + Row(row_, unknowns).dot(Row(parameters[0], unknowns));
    if (jacobians && jacobians[0]) std::copy_n(row_, unknowns, jacobians[0]);
    return true;
  }

private:
  double start_;
  const double* row_;
};

/// Counts iterations, and ends them once the progress was cancelled.
class Watch final : public ceres::IterationCallback {
public:
  explicit Watch(hbProgress& progress) : progress_(progress) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    try {
      progress_.advance(1);
    } catch (const hbCancelled&) {
      return ceres::SOLVER_TERMINATE_SUCCESSFULLY; // which keeps the best
    }
    return ceres::SOLVER_CONTINUE;
  }

private:
  hbProgress& progress_;
};

/// The problem in unknowns of which each, changed by 1, changes the residuals by a root mean square of 1, whatever the
/// others are. Normal equations lose nothing then, and take half the memory and a fraction of the time of a QR
/// decomposition. Residuals are divided by their root mean square.
class Fit {
public:
  explicit Fit(const hbOpticom& problem) : problem_(problem), grids_(problem.grid.indexSet().componentGrids()) {}

  /// Throws hbCancelled.
  void prepare(hbProgress& progress) {
    const std::vector<std::int64_t> chosen = chosenSamples(problem_.samples, problem_.mostSamples);
    start_ = -valuesOf(problem_.samples, chosen);
    largest_ = start_.lpNorm<Eigen::Infinity>();
    rows_.resize(start_.size(), Eigen::Index(grids_.size()));
    const std::vector<double> nodal = problem_.grid.nodalValues(problem_.component);
    progress.begin("interpolating component grids", std::int64_t(grids_.size()), "grids");
    for (std::size_t l = 0; l < grids_.size(); ++l) {
      interpolate(problem_, grids_[l], nodal, chosen, rows_.col(Eigen::Index(l)));
      start_ += double(grids_[l].coefficient) * rows_.col(Eigen::Index(l));
      progress.advance(1);
    }
    scale_ = std::sqrt(start_.squaredNorm() / double(start_.size()));
    if (scale_ > 0.0) start_ /= scale_;
    orthogonalise(progress);
  }

  void solve(hbProgress& progress, hbOpticom::Solution& solution) {
    solution.samples = start_.size();
    solution.condition = condition_;
    solution.determined = int(unknowns_.size());
    const bool isEstimated = solution.loss.kind == hbFitLoss::Kind::huber && !(solution.loss.threshold > 0.0);
    if (isEstimated) solution.loss.threshold = estimatedThreshold();
    if (unknowns_.size() == 0 || !(scale_ > 0.0)) {
      solution.converged = true;
      return;
    }
    progress.begin("fitting coefficients", 0, "iterations");
    Watch watch(progress);
    ceres::LossFunctionWrapper loss(nullptr, ceres::TAKE_OWNERSHIP);
    const auto setLoss = [&] {
      if (solution.loss.kind == hbFitLoss::Kind::huber)
        loss.Reset(new ceres::HuberLoss(solution.loss.threshold / scale_), ceres::TAKE_OWNERSHIP);
    };
    std::deque<SampleCost> costs;
    ceres::Problem::Options shared;
    shared.cost_function_ownership = shared.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    shared.disable_all_safety_checks = true;
    ceres::Problem problem(shared);
    for (Eigen::Index j = 0; j < start_.size(); ++j)
      problem.AddResidualBlock(&costs.emplace_back(start_[j], &rows_(j, 0), int(unknowns_.size())), &loss,
                               unknowns_.data());

    bool isSettled = !isEstimated;
    while (!isSettled && !solution.interrupted && solution.rounds < kMostRounds) {
      setLoss();
      minimise(problem, watch, kRoughly, solution);
      const double threshold = estimatedThreshold();
      isSettled = std::abs(threshold - solution.loss.threshold) <= kSameThreshold * solution.loss.threshold;
      solution.loss.threshold = threshold;
      ++solution.rounds;
    }
    if (!solution.interrupted) {
      setLoss();
      minimise(problem, watch, kFinely, solution);
      ++solution.rounds;
    }
    solution.converged = solution.converged && isSettled;
    // What was interrupted may be the best for another threshold than the last one.
    const hbFitLoss scaled{solution.loss.kind, solution.loss.threshold / scale_};
    if (costOf(residuals(), scaled) > costOf(start_, scaled)) unknowns_.setZero();
  }

  /// Adds what the unknowns stand for.
  void addTo(std::vector<double>& coefficients) const {
    if (unknowns_.size() == 0 || !(scale_ > 0.0)) return;
    const Vector change = scale_ * (basis_ * unknowns_);
    double others = 0.0;
    for (Eigen::Index l = 1; l < change.size(); ++l) {
      coefficients[std::size_t(l)] += change[l];
      others += change[l];
    }
    coefficients[0] += change[0] - others;
  }

private:
  static constexpr int kMostRounds = 20;
  /// How much less of the cost an iteration may bring down before it is the last one.
  static constexpr double kRoughly = 1e-4, kFinely = 1e-10;
  /// A threshold off by this changes what Huber's loss loses against plain least squares, 5 %, by 0.1 %.
  static constexpr double kSameThreshold = 0.01;

  /// Columns to differences from the first one, which large offsets do not make parallel, and these to unknowns.
  void orthogonalise(hbProgress& progress) {
    forEachBlock(rows_.rows(), [&](Eigen::Index first, Eigen::Index count) {
      auto block = rows_.middleRows(first, count);
      for (Eigen::Index l = 1; l < rows_.cols(); ++l) block.col(l) -= block.col(0);
    });
    const Matrix triangle = triangleOf(rows_, progress);
    condition_ = conditionOf(triangle);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(triangle, Eigen::ComputeFullV);
    // Samples of 32 bits are off by up to half a unit in the last place, differences of two interpolants by twice that.
    const double columns = std::sqrt(double(rows_.cols()));
    const double least = 0x1p-24 * columns * triangle.colwise().norm().maxCoeff();
    const Vector& singular = svd.singularValues();
    Eigen::Index count = 0;
    while (count < singular.size() && singular[count] > least) ++count;
    basis_ = svd.matrixV().leftCols(count) * singular.head(count).cwiseInverse().asDiagonal();
    basis_ *= std::sqrt(double(rows_.rows()));
    forEachBlock(rows_.rows(), [&](Eigen::Index first, Eigen::Index size) {
      const Matrix block = rows_.middleRows(first, size) * basis_;
      rows_.block(first, 0, size, count) = block;
    });
    unknowns_ = Vector::Zero(count);
  }

  void minimise(ceres::Problem& problem, Watch& watch, double tolerance, hbOpticom::Solution& solution) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.num_threads = 1; // sums would depend on their number
    options.logging_type = ceres::SILENT;
    hb::silenceCeres();
    options.initial_trust_region_radius = options.max_trust_region_radius; // full steps: the problem is convex
    options.function_tolerance = tolerance;
    options.gradient_tolerance = options.parameter_tolerance = 0.0;
    options.max_num_iterations = 100;
    options.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    solution.iterations += std::int64_t(summary.iterations.size()) - 1;
    solution.converged = summary.termination_type == ceres::CONVERGENCE;
    solution.interrupted = summary.termination_type == ceres::USER_SUCCESS;
  }

  /// In units of scale_.
  Vector residuals() const { return start_ + rows_.leftCols(unknowns_.size()) * unknowns_; }

  static double costOf(const Vector& residuals, const hbFitLoss& loss) {
    double sum = 0.0;
    for (const double r : residuals) sum += loss.cost(r);
    return sum;
  }

  /// Of the samples at which interpolation is off by more than rounding: where most of a volume is constant, most
  /// residuals are 0 and tell nothing.
  double estimatedThreshold() const {
    const Vector now = residuals();
    const double least = 0x1p-24 * largest_;
    std::vector<float> magnitudes;
    for (Eigen::Index j = 0; j < now.size(); ++j)
      if (scale_ * std::abs(start_[j]) > least) magnitudes.push_back(float(std::abs(now[j])));
    return std::max(scale_ * hbFitLoss::thresholdOf(magnitudes), least);
  }

  const hbOpticom& problem_;
  Grids grids_;
  Vector start_;         ///< The residuals of interpolation, in units of scale_.
  double scale_ = 0.0;   ///< Their root mean square, in field values.
  double largest_ = 0.0; ///< Of the samples' magnitudes.
  Matrix rows_;          ///< A row a sample: how its residual changes with the unknowns, in the first columns.
  /// From unknowns to what the coefficients change by; instead of the first one's change it has the sum of all.
  Matrix basis_;
  Vector unknowns_;
  double condition_ = 0.0;
};

} // namespace

hbOpticom::Solution hbOpticom::solve(hbProgress& progress) const {
  Solution solution;
  solution.loss = loss;
  for (const hbIndexSet::ComponentGrid& one : grid.indexSet().componentGrids())
    solution.coefficients.push_back(one.coefficient);
  Fit fit(*this);
  try {
    fit.prepare(progress);
  } catch (const hbCancelled&) {
    solution.interrupted = true;
    return solution;
  }
  fit.solve(progress, solution);
  fit.addTo(solution.coefficients);
  return solution;
}

double hbOpticom::bytes(const hbIndexSet& set, std::int64_t samples) {
  const Grids grids = set.componentGrids();
  double largest = 0.0;
  for (const auto& one : grids)
    largest = std::max(largest, double(one.nodes.x) * double(one.nodes.y) * double(one.nodes.z));
  // Twice the matrix, ours and the solver's. What the solver keeps of each sample beside it was measured: 230 bytes.
  constexpr double kPerSample = 320.0, kValue = double(sizeof(double));
  const double columns = double(grids.size());
  const double blocks = double(kRows) * hb::parallelThreads() + columns * std::ceil(double(samples) / double(kRows));
  return double(samples) * (2.0 * kValue * columns + kPerSample) + blocks * columns * kValue +
         kValue * (double(set.storedValues()) + largest);
}

std::vector<double> hbOpticom::surpluses(const hbSparseGrid& grid, int component,
                                         std::span<const double> coefficients) {
  const hbIndexSet& set = grid.indexSet();
  const Grids grids = set.componentGrids();
  if (coefficients.size() != grids.size())
    throw hbError(fmt::format("opticom: expected {} coefficients, found {}", grids.size(), coefficients.size()));
  std::vector<double> scaled;
  scaled.reserve(std::size_t(set.storedValues()));
  for (const hbSubspace& subspace : set.subspaces()) {
    double factor = 0.0;
    for (std::size_t l = 0; l < grids.size(); ++l)
      if (glm::all(glm::lessThanEqual(subspace.levels, grids[l].levels))) factor += coefficients[l];
    for (const float surplus : grid.surpluses(subspace, component)) scaled.push_back(factor * double(surplus));
  }
  return scaled;
}
