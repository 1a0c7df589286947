#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

/// A map from [0,1] to colours, computed from its published formula.
///
/// - `gray`: black to white, straight in coded sRGB; `inverse-gray`: white to black.
/// - `heat`: black, red, yellow, white at 0, 1/3, 2/3, 1, straight in coded sRGB between; its luminance only grows.
/// - `cubehelix`: D. A. Green, "A colour scheme for the display of astronomical intensity images", Bull. Astr. Soc.
///   India 39, 289 (2011), with its defaults: start 0.5, -1.5 rotations, hue 1, gamma 1.
/// - `coolwarm`: K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009: from (59, 76, 192) over
///   white to (180, 4, 38) in Msh space. For signed values, 0 in the middle.
class hbColormap {
public:
  /// Throws hbError listing the known names for another one.
  explicit hbColormap(std::string_view name);

  std::string_view name() const;

  /// The coded sRGB colour, each channel in [0,1]; t is clamped to [0,1], and NaN counts as 0.
  glm::dvec3 rgb(double t) const;

  static std::span<const std::string_view> names();

private:
  std::size_t index_; ///< Into names().
};
