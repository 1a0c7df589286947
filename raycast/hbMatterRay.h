#pragma once

#include <vector>

#include "raycast/hbCentralDifferences.h"
#include "raycast/hbEmissionAbsorption.h"
#include "raycast/hbMatter.h"
#include "raycast/hbRaySegment.h"
#include "scene/hbRay.h"

/// What is seen along a ray through matter, lit as the scene says. Gradients are taken of what is seen alone, and
/// several at a time. One thread each.
class hbMatterRay {
public:
  /// Keeps references to everything.
  hbMatterRay(const hbField& field, const hbScene& scene, const hbMatter& matter);

  /// Begins another ray.
  void begin(const hbRay& ray, const hbRaySegment& segment);

  /// The next piece: of hbMatter::at() or slab(), so long in the world, its middle so far from the ray's origin in the
  /// world. False once nothing behind it shows.
  bool add(const glm::vec4& piece, double length, double middle) {
    if (!(piece.a > 0.0F)) return true;
    if (isLit_) return addLit(piece, length, middle);
    compose({piece, length}, {});
    return !light_.isOpaque();
  }

  const hbEmissionAbsorption& finish();

private:
  struct Piece {
    glm::vec4 matter;
    double length;
  };
  void compose(const Piece& piece, const hbShading::Reflection& reflection) {
    if (matter_.isPreintegrated())
      light_.addSlab(piece.matter, piece.length / matter_.step(), reflection);
    else
      light_.add(piece.matter, piece.length, reflection);
  }
  bool addLit(const glm::vec4& piece, double length, double middle);
  void composeLit();

  const hbScene& scene_;
  const hbMatter& matter_;
  hbCentralDifferences differences_;
  bool isLit_;
  glm::dmat4 cubeToWorld_;
  hbRay ray_;
  hbRaySegment segment_;
  hbEmissionAbsorption light_;
  std::vector<Piece> waiting_; ///< For their gradients.
  std::vector<glm::dvec3> places_;
  double ahead_ = 1.0; ///< The transmittance behind what is waiting, at least.
};
