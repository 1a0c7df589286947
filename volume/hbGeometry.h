#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

/// Numbers of nodes or samples along x, y, z.
using hbSize3 = glm::vec<3, std::int64_t>;

/// Where the samples of a volume lie: sizes, and the map from the unit cube to world space.
///
/// Sample (i,j,k) lies at i/(size-1) along each axis of the cube [0,1]^3, and in world space at
/// `origin + direction * (spacing * (i,j,k))`, whatever the centring. An axis with one sample is flat: the field is
/// constant along it, and the cube's edge covers one spacing, half of it on each side of the sample.
struct hbGeometry {
  /// `cell`: the file said that its samples are the centres of cells, so its own box is half a voxel larger on every
  /// side than ours. The flag is kept so that the file is written back as it was.
  enum class Centring : std::uint8_t { node = 0, cell = 1 };

  hbSize3 size{1, 1, 1};
  glm::dvec3 origin{0.0};    ///< World position of the first sample.
  glm::dvec3 spacing{1.0};   ///< World distance between neighbouring samples; positive (a flip is in `direction`).
  glm::dmat3 direction{1.0}; ///< Column d is the unit vector of axis d in world space.
  Centring centring = Centring::node;
  /// The world's name where the file gave one ("left-posterior-superior"), otherwise empty.
  std::string space;

  bool isFlat(int axis) const { return size[axis] == 1; }

  /// The number of samples; valid after validate().
  std::int64_t samples() const { return size.x * size.y * size.z; }

  /// World lengths of the cube's three edges.
  glm::dvec3 extent() const;

  /// Maps [0,1]^3 to world space (column-major, homogeneous).
  glm::dmat4 cubeToWorld() const;

  /// Distance between samples in cube units: 1/(size-1), and 1 along flat axes.
  glm::dvec3 cubeSpacing() const;

  /// Where the samples of an axis lie in the cube: i/(size-1), and 1/2 on a flat axis.
  std::vector<double> cubeCoordinates(int axis) const;

  /// Throws hbError naming `what` unless sizes are >= 1 with a product below 2^60, spacings lie in [1e-80, 1e80], the
  /// origin in [-1e80, 1e80], and direction is finite with three independent unit columns.
  void validate(const std::string& what) const;

  bool operator==(const hbGeometry&) const = default;
};
