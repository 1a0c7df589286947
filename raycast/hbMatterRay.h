#pragma once

#include "raycast/hbEmissionAbsorption.h"
#include "raycast/hbLitPieces.h"
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
    matter_.addPiece(piece, length, light_);
    return !light_.isOpaque();
  }

  const hbEmissionAbsorption& finish();

  hbMatterRay(const hbMatterRay&) = delete; // pieces know where its light is
  hbMatterRay& operator=(const hbMatterRay&) = delete;

private:
  bool addLit(const glm::vec4& piece, double length, double middle);

  const hbScene& scene_;
  const hbMatter& matter_;
  bool isLit_;
  hbLitPieces pieces_;
  hbRay ray_;
  hbRaySegment segment_;
  hbEmissionAbsorption light_;
  double ahead_ = 1.0; ///< The transmittance behind what is waiting, at least.
};
