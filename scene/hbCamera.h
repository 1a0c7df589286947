#pragma once

#include <cstdint>
#include <string>

#include <glm/vec3.hpp>

#include "scene/hbRay.h"
#include "volume/hbGeometry.h"

/// From where and how the volume is looked at. All lengths are in world units.
struct hbCamera {
  enum class Projection : std::uint8_t { orthographic, perspective };

  static constexpr double kDefaultAzimuth = 30.0;     ///< Degrees; with kDefaultElevation a pleasant angle.
  static constexpr double kDefaultElevation = 20.0;   ///< Degrees.
  static constexpr double kDefaultFieldOfView = 30.0; ///< Degrees.
  /// The picture's edge as framing() lays it, over the outermost projected corner.
  static constexpr double kFramingMargin = 1.02;

  Projection projection = Projection::perspective;
  glm::dvec3 position{0.0, -1.0, 0.0};
  glm::dvec3 target{0.0}; ///< Lies in the centre of the picture.
  glm::dvec3 up{0.0, 0.0, 1.0};
  double fieldOfView = kDefaultFieldOfView; ///< Perspective: vertical, degrees, inside (0, 180).
  double height = 1.0;                      ///< Orthographic: world height of the picture.

  /// The ray through a point of a picture of `width` x `height` square pixels: px in [0, width] to the right, py in
  /// [0, height] downwards from the top edge; pixel (i, j) has its centre at (i + 0.5, j + 0.5). Perspective rays start
  /// at `position`, orthographic ones on the plane through it. The camera must be valid.
  hbRay ray(double px, double py, int width, int height) const;

  /// ray() for many rays: what all of them have in common is worked out once.
  class Rays {
  public:
    explicit Rays(const hbCamera& camera);
    hbRay at(double px, double py, int width, int height) const;

  private:
    Projection projection_;
    glm::dvec3 position_, right_, up_,
        forward_;  ///< The camera's axes in the world: right and up in the picture, into it.
    double scale_; ///< Half the picture's height, in perspective at unit distance.
  };

  /// The unit vector from `position` to `target`.
  glm::dvec3 viewAxis() const;

  /// Throws hbError beginning with `what` and the member's name unless all members are finite, position and target
  /// differ, `up` is not parallel to the view axis, the field of view lies inside (0, 180) and height is positive.
  void validate(const std::string& what = "camera") const;

  /// The camera that looks at the centre of the volume's world box and has all eight corners just in view: the
  /// outermost one lies at 1 / kFramingMargin of the picture's edge.
  ///
  /// World z points up in the picture. At azimuth 0 and elevation 0 the camera stands at -y and looks along +y (in
  /// anatomical LPS space: at the patient's front); azimuth moves it counter-clockwise as seen from above (from +z), so
  /// 90 looks along -x; elevation in [-90, 90] raises it. Both in degrees. `aspect` is width / height of the picture.
  /// `zoom` enlarges the picture about its centre without moving the camera; values above 1 cut the corners off.
  /// Throws hbError for angles, aspects and zooms that are no such numbers, and for boxes too small or too far from the
  /// origin to be seen in 64 bits.
  static hbCamera framing(const hbGeometry& geometry, double azimuthDegrees = kDefaultAzimuth,
                          double elevationDegrees = kDefaultElevation, Projection projection = Projection::perspective,
                          double aspect = 1.0, double zoom = 1.0);

  bool operator==(const hbCamera&) const = default;
};
