#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbField.h"

/// Pictures from whole planes of samples that somebody else evaluates: planewise sampling (see hbSampling), turned
/// inside out. What hbRaycaster does along a ray, plane by plane for all rays: X-ray sums, MIP takes the greatest
/// value, an iso-surface lies between two planes, linearly interpolated.
///
/// Source: the sparse-grid paper, section 4 and Fig. 5, and draw of section 6.
class hbPlaneCompositor {
public:
  /// The samples of one plane in the volume's cube: that of pixel (x, y) at corner + (x + 1/2) right + (y + 1/2) down.
  struct Plane {
    glm::dvec3 corner{0.0}, right{0.0}, down{0.0};
  };

  /// Keeps references to `field`, which shades iso-surfaces and knows the volume, and to `scene`, which has a camera,
  /// and an iso-value in the mode iso. Throws hbError as hbRaycaster does.
  hbPlaneCompositor(const hbField& field, const hbScene& scene);

  /// How many planes there are, front to back.
  int planes() const { return planes_; }
  Plane plane(int index) const;

  /// Takes the field values of a plane, width * height, the top row first; planes in order, from 0 on. Values of
  /// samples outside the volume do not matter.
  void add(int index, std::span<const float> values);

  /// The picture, with the channels and the metadata of hbRaycaster::render().
  hbPicture finish();

private:
  /// The planes that a pixel's ray meets in the volume, and what it needs of it.
  struct Ray {
    std::int32_t first = 0, last = -1;
    double cosine = 1.0; ///< Between the ray and the view axis.
  };
  struct Crossing {
    std::size_t pixel = 0;
    double place = 0.0; ///< Between planes: their index and a part.
  };

  void shade(hbPicture& picture) const;
  double distance(double place) const { return near_ + (place + 0.5) * step_; }

  const hbField& field_;
  const hbScene& scene_;
  hbCamera camera_;
  glm::dmat4 worldToCube_;
  int planes_ = 0, added_ = 0;
  double near_ = 0.0, step_ = 1.0;
  float iso_ = 0.0F;
  std::vector<Ray> rays_;
  std::vector<double> sums_;    ///< X-ray.
  std::vector<float> greatest_; ///< MIP; iso: of the plane before.
  std::vector<Crossing> crossings_;
  std::vector<bool> isFound_;
};
