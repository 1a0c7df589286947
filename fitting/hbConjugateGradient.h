#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

/// The preconditioned conjugate-gradient method for H x = b, H symmetric and positive definite (or semi-definite, with
/// b in its range), from x = 0: minimises x'Hx/2 - b'x. Sums are added in a fixed order.
///
/// Source: Hestenes and Stiefel, Methods of conjugate gradients for solving linear systems (1952). The eigenvalues of H
/// with the preconditioner are estimated by those of the Lanczos process that comes with it (Golub and Van Loan, Matrix
/// Computations).
class hbConjugateGradient {
public:
  /// out = H in; false: interrupted.
  using Operator = std::function<bool(std::span<const double> in, std::span<double> out)>;

  struct Settings {
    /// What the minimum would be of, without what x takes off: ends where the last kLook steps together took off less
    /// than tolerance^2 times what is left of it.
    double objective = 0.0;
    double tolerance = 1e-3;
    int mostIterations = 1000;
  };
  /// The error after a step is about what the next few steps take off: Strakos and Tichy, On error estimation in the
  /// conjugate gradient method, ETNA 13 (2002).
  static constexpr int kLook = 4;

  struct Result {
    std::vector<double> x;
    int iterations = 0;
    bool converged = false;
    bool interrupted = false; ///< x is that of the last whole step.
    double decrease = 0.0;    ///< What x takes off the objective.
    /// The greatest over the least of the estimated eigenvalues: from below, ever closer; NaN after no step.
    double condition = std::numeric_limits<double>::quiet_NaN();
  };

  /// `diagonal` (> 0) is the preconditioner.
  static Result solve(const Operator& h, std::span<const double> diagonal, std::span<const double> b,
                      const Settings& settings);
};
