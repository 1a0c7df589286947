#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raycast/hbRaySegment.h"
#include "raycast/hbVisibility.h"
#include "volume/hbField.h"

/// Which blocks of a volume hold values that can be seen in a DVR scene: along a ray, the others need not be sampled.
///
/// It belongs to one field, component and hbVisibility: another transfer function needs other blocks. A block is judged
/// by its values and those of one cell around it, so that a place on its faces may be rounded to either side. Source:
/// M. Levoy, "Efficient Ray Tracing of Volume Data", ACM Transactions on Graphics 9(3), 1990, section 2, with one level
/// of blocks, which rays traverse after J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing",
/// Eurographics 1987.
class hbVisibleBlocks {
public:
  static constexpr std::int64_t kCells = 8; ///< Along each edge.

  /// Asks for the range of every block, on all threads; see hbField::hasLocalRanges(). A byte a block.
  hbVisibleBlocks(const hbField& field, int component, const hbVisibility& visibility);

  /// One of the stretches of a ray that lie in visible blocks, as far as those follow each other.
  class Walk {
  public:
    /// Keeps a reference to `blocks`.
    Walk(const hbVisibleBlocks& blocks, const hbRaySegment& segment);

    /// The next one, from front to back; false behind the last.
    bool next();

    double enter() const { return enter_; } ///< World distances from the ray's origin, but for rounding.
    double leave() const { return leave_; }

  private:
    void advance();

    const hbVisibleBlocks& blocks_;
    std::array<double, 3> border_, delta_; ///< Where the ray leaves this block along each axis; between two borders.
    std::array<std::int64_t, 3> left_;     ///< Blocks behind this one along each axis.
    std::array<std::int64_t, 3> stride_;
    std::int64_t block_ = 0;
    double here_, end_; ///< Where the ray enters this block, and leaves the volume.
    double enter_ = 0.0, leave_ = 0.0;
  };

  /// Block (x, y, z) has the cells kCells * x to kCells * x + kCells - 1, and so on.
  const hbSize3& size() const { return size_; }
  bool isVisible(const hbSize3& block) const { return visible_[indexOf(block)] != 0; }

private:
  std::size_t indexOf(const hbSize3& block) const {
    return std::size_t(block.x + size_.x * (block.y + size_.y * block.z));
  }

  hbSize3 size_;
  glm::dvec3 perCube_; ///< Blocks along the cube's edges; the last one may be cut off.
  std::vector<std::uint8_t> visible_;
};
