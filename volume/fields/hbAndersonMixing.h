#pragma once

#include <cstddef>
#include <vector>

/// Finds the fixed point x = G(x) of a slowly converging map in fewer evaluations: Anderson's mixing (Iterative
/// procedures for nonlinear integral equations, J. ACM 12, 1965; in the form of Walker and Ni, SIAM J. Numer. Anal. 49,
/// 2011, equation 2.2, without damping).
///
/// From the last `depth` changes of x it takes the combination that would have made G(x) - x smallest. On a linear map
/// that is GMRES.
class hbAndersonMixing {
public:
  /// `size`: of x; `depth`: how many earlier iterates count, at least 1. Memory: 2 size doubles, 2 size depth floats.
  hbAndersonMixing(std::size_t size, std::size_t depth);

  /// `x` and `mapped` = G(x); `x` becomes the next iterate. Starts anew where |G(x) - x| grew by more than 4.
  /// O(depth size), on all threads; the result does not depend on their number.
  void next(std::vector<double>& x, const std::vector<double>& mapped);

private:
  struct Change {
    std::vector<float> residual, mapped; ///< Differences to the iterate before.
  };
  std::size_t depth_;
  std::vector<double> residual_, mapped_;     ///< Of the last iterate; `residual_` is G(x) - x.
  double squared_ = 0.0;                      ///< |residual_|^2
  std::vector<Change> changes_;               ///< Oldest first.
  std::vector<std::vector<double>> products_; ///< Of the changes' residuals with each other.
};
