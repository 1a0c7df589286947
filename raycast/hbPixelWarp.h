#pragma once

#include <span>
#include <vector>

#include "raycast/hbShearFactorisation.h"
#include "scene/hbPicture.h"
#include "scene/hbScene.h"
#include "volume/hbField.h"

/// Takes what intermediate rays have gathered to the pixels of a picture. hbShearWarp says what becomes of it.
class hbPixelWarp {
public:
  /// Adds the channels of the scene's mode to `picture`, as hbRaycaster has them. Keeps references to everything.
  hbPixelWarp(const hbPixelRays& rays, const hbScene& scene, const hbField& field, int component, hbPicture& picture);

  /// X-ray and MIP: `image` holds a mean or a maximum for each of the rays, NaN for none. Parallel over rows.
  void values(const hbShearFactorisation& rays, std::span<const double> image);
  /// Iso: `crossings` holds each ray's place among the slices, infinite for none. Seven values of the field a crossing.
  void surface(const hbShearFactorisation& rays, std::span<const double> crossings);

  /// What either takes at its peak, in bytes.
  static double bytes(const hbShearFactorisation& rays, hbMode mode);

private:
  /// The surface as a ray sees it.
  struct Hit {
    float z = 0.0F; ///< Distance along the view axis; infinite: no surface.
    float value = 0.0F;
    glm::vec3 normal{0.0F};
  };
  std::vector<Hit> shade(const hbShearFactorisation& rays, std::span<const double> crossings) const;
  void put(int x, int y, const hbShearFactorisation& rays, std::span<const Hit> hits);

  const hbPixelRays& rays_;
  const hbScene& scene_;
  const hbField& field_;
  int component_;
  double step_; ///< World distance between slices along the view axis.
  std::vector<float>*y_, *a_, *z_ = nullptr, *nx_ = nullptr, *ny_ = nullptr, *nz_ = nullptr, *value_ = nullptr;
};
