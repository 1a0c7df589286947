#include "report/hbParetoFront.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

std::vector<bool> hb::paretoFront(std::span<const CostAndError> choices) {
  std::vector<std::size_t> order(choices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return choices[a].cost != choices[b].cost ? choices[a].cost < choices[b].cost : choices[a].error < choices[b].error;
  });
  std::vector<bool> front(choices.size(), false);
  double leastError = std::numeric_limits<double>::infinity(); // of all that cost less
  for (std::size_t first = 0; first < order.size();) {
    const CostAndError& best = choices[order[first]];
    std::size_t last = first;
    for (; last < order.size() && choices[order[last]].cost == best.cost; ++last)
      front[order[last]] = choices[order[last]].error == best.error && best.error < leastError;
    leastError = std::min(leastError, best.error);
    first = last;
  }
  return front;
}
