#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Dense>

#include "fitting/hbFitSamples.h"
#include "fitting/hbLeastSquares.h"
#include "sparsegrid/hbHat.h"

/// A least-squares problem as a plain 64-bit matrix: the reference for every way to solve it. For hundreds of nodes.
class hbDenseFit {
public:
  explicit hbDenseFit(const hbLeastSquares& problem) : problem_(problem) {
    const hbFitSamples& samples = problem.samples;
    rows_ = Eigen::MatrixXd::Zero(samples.fittedCount(), problem.set.storedValues());
    data_.resize(samples.fittedCount());
    Eigen::Index row = 0;
    std::int64_t sample = 0;
    std::vector<float> plane(std::size_t(samples.samplesOfPlane()));
    for (std::int64_t k = 0; k < samples.size().z; ++k) {
      samples.plane(k, plane);
      for (std::int64_t j = 0; j < samples.size().y; ++j)
        for (std::int64_t i = 0; i < samples.size().x; ++i, ++sample) {
          if (hbFitSamples::isHeldOut(sample)) continue;
          data_[row] = double(plane[std::size_t(sample % samples.samplesOfPlane())]);
          fill(row++, {samples.coordinates(0)[std::size_t(i)], samples.coordinates(1)[std::size_t(j)],
                       samples.coordinates(2)[std::size_t(k)]});
        }
    }
    smoothing_.resize(rows_.cols());
    for (const hbSubspace& s : problem.set.subspaces())
      smoothing_.segment(s.offset, s.count()).setConstant(hbLeastSquares::smoothingWeight(s.levels));
  }

  /// The surpluses, by a QR factorisation; with a robust loss, by weighing anew until nothing changes.
  std::vector<double> solve() const {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(rows_.rows()), surpluses = solve(weights);
    if (problem_.loss.kind != hbFitLoss::Kind::none)
      for (int round = 0; round < 500; ++round) {
        const Eigen::VectorXd residuals = rows_ * surpluses - data_;
        for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] = problem_.loss.weight(residuals[i]);
        const Eigen::VectorXd next = solve(weights);
        const bool done = (next - surpluses).norm() <= 1e-12 * next.norm();
        surpluses = next;
        if (done) break;
      }
    return {surpluses.begin(), surpluses.end()};
  }

  /// The objective.
  double objective(const std::vector<double>& surpluses) const {
    const Eigen::Map<const Eigen::VectorXd> a(surpluses.data(), Eigen::Index(surpluses.size()));
    double cost = 0.0;
    for (const double r : Eigen::VectorXd(rows_ * a - data_)) cost += problem_.loss.cost(r);
    return cost / double(rows_.rows()) + 0.5 * problem_.smoothing * (smoothing_.array() * a.array().square()).sum();
  }

  /// transpose(A) A / M + smoothing, for surpluses.
  Eigen::MatrixXd normal() const {
    Eigen::MatrixXd matrix = rows_.transpose() * rows_ / double(rows_.rows());
    matrix.diagonal() += problem_.smoothing * smoothing_;
    return matrix;
  }

private:
  void fill(Eigen::Index row, const glm::dvec3& point) {
    const hbIndexSet& set = problem_.set;
    std::array<hbHat<double>, 3> hats;
    for (int d = 0; d < 3; ++d) hats[std::size_t(d)].evaluate(point[d], set.flat()[d], set.finest()[d]);
    for (const hbSubspace& s : set.subspaces())
      for (int corner = 0; corner < 8; ++corner) {
        double weight = 1.0;
        glm::i64vec3 node(0);
        for (int d = 0; d < 3; ++d) {
          const bool second = (corner >> d & 1) != 0;
          const hbHat<double>& hat = hats[std::size_t(d)];
          if (second && (s.levels[d] > 0 || set.flat()[d])) {
            weight = 0.0;
            break;
          }
          const auto slot = std::size_t(s.levels[d] > 0 ? s.levels[d] + 1 : second ? 1 : 0);
          weight *= hat.weight[slot];
          node[d] = hat.node[slot];
        }
        if (weight != 0.0) rows_(row, s.offset + node.x + s.nodes.x * (node.y + s.nodes.y * node.z)) += weight;
      }
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& weights) const {
    const Eigen::Index count = rows_.rows(), nodes = rows_.cols();
    Eigen::MatrixXd all(count + nodes, nodes);
    Eigen::VectorXd right(count + nodes);
    const Eigen::VectorXd roots = (weights / double(count)).cwiseSqrt();
    all.topRows(count) = roots.asDiagonal() * rows_;
    right.head(count) = roots.cwiseProduct(data_);
    all.bottomRows(nodes) = Eigen::VectorXd((problem_.smoothing * smoothing_).cwiseSqrt()).asDiagonal();
    right.tail(nodes).setZero();
    return all.colPivHouseholderQr().solve(right);
  }

  hbLeastSquares problem_;
  Eigen::MatrixXd rows_;
  Eigen::VectorXd data_, smoothing_;
};
