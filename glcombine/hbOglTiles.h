#pragma once

#include <algorithm>
#include <cmath>

/// How some planes of a picture lie side by side in one target, so that one draw goes into all of them: row by row.
class hbOglTiles {
public:
  /// At a time. Coordinates are interpolated across the whole target, and rounded as much more as it is larger than a
  /// tile; more tiles are hardly faster.
  static constexpr int kMost = 8;

  /// As many tiles of width x height, `planes` at the most, as make a target of a moderate size (16 MB of floats),
  /// about a square. `mostTexels`: the largest side of a target, at least that of one tile.
  hbOglTiles(int width, int height, int planes, int mostTexels) : width_(width), height_(height) {
    constexpr double kPixels = 1 << 22;
    const double fit = kPixels / (double(width) * double(height));
    const int wanted = std::clamp(int(std::min(fit, double(kMost))), 1, std::max(planes, 1));
    const double side = std::sqrt(double(wanted) * width * height) + width;
    columns_ = std::clamp(int(std::min(side, double(mostTexels))) / width, 1, wanted);
    rows_ = std::clamp(mostTexels / height, 1, (wanted + columns_ - 1) / columns_);
    count_ = std::min(wanted, columns_ * rows_);
  }

  int count() const { return count_; }
  int columns() const { return columns_; }
  /// Of one tile.
  int width() const { return width_; }
  int height() const { return height_; }
  /// Of the target.
  int targetWidth() const { return columns_ * width_; }
  int targetHeight() const { return rows_ * height_; }
  /// A tile's first pixel in the target.
  int x(int tile) const { return tile % columns_ * width_; }
  int y(int tile) const { return tile / columns_ * height_; }

private:
  int width_, height_, columns_, rows_, count_;
};
