#pragma once

#include <algorithm>
#include <vector>

namespace hb {

/// The median of a list that is not empty: of an even number, the mean of the two in the middle.
inline double median(std::vector<double> list) {
  const auto middle = list.begin() + std::ptrdiff_t(list.size() / 2);
  std::nth_element(list.begin(), middle, list.end());
  if (list.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(list.begin(), middle) + *middle);
}

} // namespace hb
