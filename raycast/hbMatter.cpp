#include "raycast/hbMatter.h"

#include <algorithm>
#include <cmath>

hbMatter::hbMatter(const hbScene& scene, const hbValueMap& map, double step)
    : map_(map), step_(step), gradientOpacity_(scene.gradientOpacity) {
  if (!scene.preintegrated) {
    table_.emplace(*scene.transfer);
    return;
  }
  // Over the function's range and a cell more at either end, which what is beyond counts as.
  constexpr std::size_t kEntries = 1024;
  const auto [lo, hi] = scene.transfer->range();
  const double cell = (hi - lo) / double(kEntries - 3);
  slabs_.emplace(*scene.transfer, lo - cell, hi + cell, step, kEntries);
}

double hbMatter::shownBy(double gradient) const {
  if (!gradientOpacity_) return 1.0;
  const auto [lo, hi] = *gradientOpacity_;
  return std::clamp((gradient * std::abs(map_.scale) - lo) / (hi - lo), 0.0, 1.0);
}
