#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "raycast/hbMatter.h"
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

  /// DVR: `image` holds, for each of the rays, the constant matter that shows what the ray does over its length in the
  /// cube (see hbEmissionAbsorption::matter()), its extinction NaN where the ray meets no slice. `matter` is what
  /// values show where no ray does, lit as the scene says.
  void light(const hbShearFactorisation& rays, std::span<const glm::vec4> image, const hbMatter& matter);

  /// What any of them takes at its peak, in bytes.
  static double bytes(const hbShearFactorisation& rays, hbMode mode);

private:
  /// The surface as a ray sees it.
  struct Hit {
    float z = 0.0F; ///< Distance along the view axis; infinite: no surface.
    float value = 0.0F;
    glm::vec3 normal{0.0F};
  };
  /// Pixels without a ray around them that meets a slice.
  struct Lonely {
    std::vector<std::size_t> pixels;
    std::vector<double> lengths;
    std::vector<glm::dvec3> middles;
    std::vector<float> values; ///< The field's in the middles.
  };
  /// Calls blend(pixel, neighbours, length) for every pixel whose ray meets the cube, `length` its way there in the
  /// world, and alone(lonely) with those where blend() says that there was nothing to blend, some at a time.
  template <class Blend, class Alone>
  void blendPixels(const hbShearFactorisation& rays, Blend blend, Alone alone) const;
  std::vector<Hit> shade(const hbShearFactorisation& rays, std::span<const double> crossings) const;
  void showAlone(const Lonely& lonely, const hbMatter& matter);
  void show(std::size_t pixel, const glm::dvec3& colour, double opacity);
  void put(int x, int y, const hbShearFactorisation& rays, std::span<const Hit> hits);

  const hbPixelRays& rays_;
  const hbScene& scene_;
  const hbField& field_;
  int component_;
  double step_; ///< World distance between slices along the view axis.
  std::array<std::vector<float>*, 3> rgb_{};
  std::vector<float>*y_, *a_, *z_ = nullptr, *nx_ = nullptr, *ny_ = nullptr, *nz_ = nullptr, *value_ = nullptr;
};
