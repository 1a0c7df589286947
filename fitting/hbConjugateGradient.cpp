#include "fitting/hbConjugateGradient.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// y = x + factor y
void addTo(std::span<const double> x, double factor, std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = x[i] + factor * y[i];
}

/// y += factor x
void add(double factor, std::span<const double> x, std::span<double> y) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

/// Of the tridiagonal matrix of the Lanczos process, from the steps' lengths and what each direction keeps of the one
/// before.
double conditionOf(const std::vector<double>& lengths, const std::vector<double>& kept) {
  const auto size = Eigen::Index(lengths.size());
  if (size == 0) return std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd diagonal(size), beside(std::max<Eigen::Index>(size - 1, 0));
  for (Eigen::Index k = 0; k < size; ++k) {
    const auto at = std::size_t(k);
    diagonal[k] = 1.0 / lengths[at] + (k > 0 ? kept[at - 1] / lengths[at - 1] : 0.0);
    if (k + 1 < size) beside[k] = std::sqrt(kept[at]) / lengths[at];
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[size - 1] / solver.eigenvalues()[0];
}

} // namespace

hbConjugateGradient::Result hbConjugateGradient::solve(const Operator& h, std::span<const double> diagonal,
                                                       std::span<const double> b, const Settings& settings) {
  Result result;
  result.x.assign(b.size(), 0.0);
  std::vector<double> residual(b.begin(), b.end()), preconditioned(b.size()), direction(b.size(), 0.0), image(b.size());
  std::vector<double> lengths, kept, taken;
  const auto precondition = [&] {
    for (std::size_t i = 0; i < b.size(); ++i) preconditioned[i] = residual[i] / diagonal[i];
    return dot(residual, preconditioned);
  };
  double size = precondition();
  const double first = size;
  addTo(preconditioned, 0.0, direction);
  while (result.iterations < settings.mostIterations) {
    // Below that, residuals are the rounding of what was subtracted.
    if (size <= first * 0x1p-100) {
      result.converged = true;
      break;
    }
    if (!h(direction, image)) {
      result.interrupted = true;
      break;
    }
    const double curvature = dot(direction, image);
    if (!(curvature > 0.0)) break; // a direction that H does not know: rounding has taken over
    const double length = size / curvature;
    add(length, direction, result.x);
    add(-length, image, residual);
    ++result.iterations;
    lengths.push_back(length);
    taken.push_back(0.5 * length * size);
    result.decrease += taken.back();
    const double left = std::max(settings.objective - result.decrease, 0.0);
    if (taken.size() >= kLook &&
        std::accumulate(taken.end() - kLook, taken.end(), 0.0) <= settings.tolerance * settings.tolerance * left) {
      result.converged = true;
      break;
    }
    const double before = size;
    size = precondition();
    kept.push_back(size / before);
    addTo(preconditioned, kept.back(), direction);
  }
  result.condition = conditionOf(lengths, kept);
  return result;
}
