#include "glcombine/hbTermOrder.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

std::vector<std::size_t> hb::interleaved(std::span<const int> coefficients) {
  std::map<int, std::vector<std::size_t>> left; // the terms of each coefficient, the last one first
  for (std::size_t i = coefficients.size(); i-- > 0;) left[coefficients[i]].push_back(i);
  std::vector<std::size_t> order;
  std::int64_t sum = 0;
  const auto away = [&](const auto& terms) {
    const std::int64_t next = sum + terms.first;
    return std::max({-next, next - 1, std::int64_t{0}}); // from [0,1]
  };
  while (!left.empty()) {
    const auto next = std::min_element(left.begin(), left.end(), [&](const auto& a, const auto& b) {
      return std::pair(away(a), a.second.back()) < std::pair(away(b), b.second.back());
    });
    sum += next->first;
    order.push_back(next->second.back());
    next->second.pop_back();
    if (next->second.empty()) left.erase(next);
  }
  return order;
}
