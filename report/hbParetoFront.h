#pragma once

#include <span>
#include <vector>

namespace hb {

/// A choice as its cost (seconds, bytes) and its error; both finite.
struct CostAndError {
  double cost = 0.0, error = 0.0;
};

/// Which of the choices are on the Pareto front: no other one is as good or better in both cost and error, and better
/// in one. Of equal choices all are, or none. O(n log n).
std::vector<bool> paretoFront(std::span<const CostAndError> choices);

} // namespace hb
