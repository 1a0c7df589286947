#pragma once

#include <cstdint>

#include "scene/hbCamera.h"
#include "volume/hbGeometry.h"

/// Where along its ray a renderer looks at the field.
struct hbSampling {
  enum class Kind : std::uint8_t {
    equidistant, ///< Midpoints of equal steps along each ray: L / ceil(L / stepLength) for a ray with L in the box.
    planewise    ///< On planes across the view axis, stepLength apart; the weight is stepLength over the cosine.
  };
  static constexpr int kMaxSamples = 1 << 20;

  /// An interval of distances from the camera's position, measured along the view axis.
  struct Extent {
    double near, far;
  };

  Kind kind = Kind::equidistant;
  int samples = 0; ///< Samples over the box's extent along the view axis (planes); 0: one a voxel. At most kMaxSamples.

  /// The extent of the volume's world box along the view axis; near is negative where the box reaches behind the
  /// camera.
  static Extent extent(const hbGeometry& geometry, const hbCamera& camera);

  /// The number of planes: `samples`, or, where that is 0, the fewest that lie no farther apart than the smallest world
  /// spacing of the axes that are not flat (of all axes when all are), at most kMaxSamples.
  int planes(const hbGeometry& geometry, const hbCamera& camera) const;

  /// World distance between planes: extent / planes.
  double stepLength(const hbGeometry& geometry, const hbCamera& camera) const;

  bool operator==(const hbSampling&) const = default;
};
