#include "raycast/hbVisibleBlocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "volume/hbParallel.h"

hbVisibleBlocks::hbVisibleBlocks(const hbField& field, int component, const hbVisibility& visibility)
    : size_((field.geometry().size + (kCells - 2)) / kCells),
      perCube_(glm::dvec3(field.geometry().size - std::int64_t(1)) / double(kCells)) {
  size_ = glm::max(size_, hbSize3(1)); // flat axes
  visible_.resize(std::size_t(size_.x * size_.y * size_.z));
  hb::parallelFor(size_.y * size_.z, [&](std::int64_t row) {
    for (hbSize3 block(0, row % size_.y, row / size_.y); block.x < size_.x; ++block.x) {
      // Half a cell is enough to meet the next ones.
      constexpr double kAround = 0.5 / double(kCells);
      const glm::dvec3 lo = (glm::dvec3(block) - kAround) / perCube_,
                       hi = (glm::dvec3(block) + (1.0 + kAround)) / perCube_;
      hbBox box;
      for (int d = 0; d < 3; ++d)
        if (!field.geometry().isFlat(d))
          box.lo[d] = float(std::max(lo[d], 0.0)), box.hi[d] = float(std::min(hi[d], 1.0));
      const hbRange range = field.range(box, component);
      visible_[indexOf(block)] = visibility.isInvisible(range.lo, range.hi) ? 0 : 1;
    }
  });
}

hbVisibleBlocks::Walk::Walk(const hbVisibleBlocks& blocks, const hbRaySegment& segment)
    : blocks_(blocks), stride_{1, blocks.size_.x, blocks.size_.x * blocks.size_.y}, here_(segment.enter),
      end_(segment.leave) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int d = 0; d < 3; ++d) {
    const auto axis = std::size_t(d);
    // In blocks from here on.
    const double origin = segment.origin[d] * blocks.perCube_[d], direction = segment.direction[d] * blocks.perCube_[d];
    const double last = double(blocks.size_[d] - 1);
    const double index = std::clamp(std::floor(origin + here_ * direction), 0.0, last);
    block_ += std::int64_t(index) * stride_[axis];
    left_[axis] = std::int64_t(direction < 0.0 ? index : last - index);
    border_[axis] = direction == 0.0 || left_[axis] == 0
                        ? kInfinity
                        : ((direction < 0.0 ? index : index + 1.0) - origin) / direction;
    delta_[axis] = direction == 0.0 ? kInfinity : 1.0 / std::abs(direction);
    if (direction < 0.0) stride_[axis] = -stride_[axis];
  }
}

void hbVisibleBlocks::Walk::advance() {
  const auto axis = std::size_t(std::min_element(border_.begin(), border_.end()) - border_.begin());
  here_ = std::min(border_[axis], end_);
  if (here_ == end_) return;
  --left_[axis];
  block_ += stride_[axis];
  // Behind the last block only the ray's end counts, which is not rounded as borders are.
  border_[axis] = left_[axis] == 0 ? std::numeric_limits<double>::infinity() : border_[axis] + delta_[axis];
}

bool hbVisibleBlocks::Walk::next() {
  const auto isVisible = [&] { return blocks_.visible_[std::size_t(block_)] != 0; };
  while (here_ < end_ && !isVisible()) advance();
  if (!(here_ < end_)) return false;
  enter_ = here_;
  while (here_ < end_ && isVisible()) advance();
  leave_ = std::min(here_, end_);
  return true;
}
