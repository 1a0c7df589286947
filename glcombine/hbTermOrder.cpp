#include "glcombine/hbTermOrder.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

std::vector<std::size_t> hb::interleaved(std::span<const double> coefficients) {
  std::map<double, std::vector<std::size_t>> left; // the terms of each coefficient, the last one first
  for (std::size_t i = coefficients.size(); i-- > 0;) left[coefficients[i]].push_back(i);
  std::vector<std::size_t> order;
  const double whole = std::accumulate(coefficients.begin(), coefficients.end(), 0.0);
  const double least = std::min(whole, 0.0), greatest = std::max(whole, 0.0);
  double sum = 0.0;
  const auto away = [&](const auto& terms) {
    const double next = sum + terms.first;
    return std::max({least - next, next - greatest, 0.0});
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
