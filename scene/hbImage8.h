#pragma once

#include <cstdint>
#include <vector>

/// An image to be looked at: 8 bits a channel, sRGB. Row-major, the top row first; red, green and blue of a pixel side
/// by side, so pixel (x, y) begins at element 3 * (x + width * y).
struct hbImage8 {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  bool operator==(const hbImage8&) const = default;
};
