#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "raycast/hbMatter.h"
#include "raycast/hbRaySegment.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbField.h"

/// The planes and the rays of a picture by planewise sampling (see hbSampling), and the picture of what was found along
/// them. A ray's sample on a plane is where it meets the plane; *places* along a ray are indices of planes and parts of
/// them.
class hbPlaneRays {
public:
  /// A rectangle of pixels.
  struct Window {
    int x = 0, y = 0, width = 0, height = 0;
  };

  /// The samples of one plane in the volume's cube: that of pixel (x, y) at corner + (x + 1/2) right + (y + 1/2) down.
  struct Plane {
    glm::dvec3 corner{0.0}, right{0.0}, down{0.0};
    Window window{}; ///< No other pixels see the volume on this plane.
  };

  /// The planes on which a pixel's ray is in the volume, or in the part of it that the clip box leaves; none where last
  /// < first.
  struct Ray {
    std::int32_t first = 0, last = -1;
    double cosine = 1.0; ///< Between the ray and the view axis.
    /// World lengths in the volume before the first plane and behind the last; of a ray that passes between two planes,
    /// or none, half of its length there each.
    double before = 0.0, behind = 0.0;
  };

  /// A piece of an iso-surface seen in a pixel.
  struct Surface {
    std::size_t pixel = 0;
    double place = 0.0;
    glm::dvec3 normal{0.0}; ///< Of the world, of length 1, towards the viewer.
    double light = 0.0;     ///< Lambert's, from the viewer: the cosine between the normal and the ray reversed.
    float value = 0.0F;     ///< The field's.
  };

  /// Of a picture of `field`, to which a reference is kept, with the scene's size, camera, sampling and clip box.
  /// Throws hbError as hbRaycaster does, and for the mode slice.
  hbPlaneRays(const hbField& field, const hbScene& scene);

  /// With its camera.
  const hbScene& scene() const { return scene_; }
  const hbField& field() const { return field_; }
  const glm::dmat4& worldToCube() const { return worldToCube_; }
  /// The field value of the scene's iso-value; 0 without one.
  float iso() const { return iso_; }

  /// How many planes there are, front to back, and the world distance between them.
  int planes() const { return planes_; }
  double step() const { return step_; }
  Plane plane(int index) const;
  /// Of all pixels, the top row first.
  const std::vector<Ray>& rays() const { return rays_; }
  /// The world length of a ray for which the sample on a plane stands, one of first to last: what lies nearest to it,
  /// the ends of the ray included.
  double share(const Ray& ray, int plane) const {
    const double half = 0.5 * step_ / ray.cosine;
    return (plane == ray.first ? ray.before : half) + (plane == ray.last ? ray.behind : half);
  }
  /// The direction of a pixel's ray in the world, of length 1, and where it is at that place, in the cube.
  glm::dvec3 direction(std::size_t pixel) const;
  glm::dvec3 at(std::size_t pixel, double place) const;

  /// Pictures with the channels and the metadata of hbRaycaster::render(), from field values: their sums over the
  /// samples of each ray, their maxima, and surfaces, one a pixel at the most.
  hbPicture xray(std::span<const double> sums) const;
  hbPicture mip(std::span<const float> maxima) const;
  hbPicture iso(std::span<const Surface> surfaces) const;
  /// From what is seen along the rays: red, green and blue in linear light, multiplied by the opacity, and the opacity.
  /// What rays that meet no plane show is found here, lit as the scene says, of one sample in the middle of each: light
  /// is not lost between two planes.
  hbPicture dvr(std::span<const glm::vec4> lights, const hbMatter& matter) const;

private:
  double distance(double place) const { return near_ + (place + 0.5) * step_; }
  hbRay ray(std::size_t pixel) const;
  std::optional<hbRaySegment> clipped(const hbRay& ray) const;
  Window window(int plane) const;
  hbPicture empty() const;
  void addBetween(std::span<glm::vec4> lights, const hbMatter& matter) const;

  const hbField& field_;
  hbScene scene_;
  glm::dmat4 worldToCube_;
  int planes_ = 0;
  double near_ = 0.0, step_ = 1.0;
  float iso_ = 0.0F;
  std::vector<Ray> rays_;
};
