#include "raycast/hbMatter.h"

#include <algorithm>
#include <cmath>

hbMatter::hbMatter(const hbScene& scene, const hbValueMap& map, double step)
    : map_(map), step_(step), gradientOpacity_(scene.gradientOpacity) {
  const auto [lo, hi] = scene.transfer->range();
  if (!scene.preintegrated) {
    table_.emplace(*scene.transfer);
    cell_ = (hi - lo) / double(table_->entries().size() - 1);
    return;
  }
  // Over the function's range and a cell more at either end, which what is beyond counts as.
  cell_ = (hi - lo) / double(kSlabEntries - 3);
  slabs_.emplace(*scene.transfer, lo - cell_, hi + cell_, step, kSlabEntries);
}

double hbMatter::bytes() const {
  return double(sizeof(glm::vec4)) * double(slabs_ ? slabs_->entries().size() : table_->entries().size());
}

double hbMatter::shownBy(double gradient) const {
  if (!gradientOpacity_) return 1.0;
  const auto [lo, hi] = *gradientOpacity_;
  return std::clamp((gradient * std::abs(map_.scale) - lo) / (hi - lo), 0.0, 1.0);
}
