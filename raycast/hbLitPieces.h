#pragma once

#include <vector>

#include "raycast/hbCentralDifferences.h"
#include "raycast/hbEmissionAbsorption.h"
#include "raycast/hbMatter.h"

/// Pieces of matter that are lit, and shown, as a scene says by its shading and gradientOpacity: they wait until
/// gradients are taken, of many at a time. One thread each.
class hbLitPieces {
public:
  /// Whether a scene shades by gradients.
  static bool areIn(const hbScene& scene) { return scene.shading || scene.gradientOpacity; }

  /// Keeps references to everything.
  hbLitPieces(const hbField& field, const hbScene& scene, const hbMatter& matter);

  /// Of hbMatter::at() or slab(), so long in the world, its middle there in the cube, seen along `ray` (of the world,
  /// of length 1, away from the viewer). Goes to `light` behind what was put there before, with compose().
  void add(const glm::vec4& piece, double length, const glm::dvec3& middle, const glm::dvec3& ray,
           hbEmissionAbsorption& light);
  std::size_t waiting() const { return waiting_.size(); }
  void clear();

  /// Takes the gradients of all that is waiting, six values each, and lets nothing wait. What is behind an opaque light
  /// is left out.
  void compose();

private:
  struct Piece {
    glm::vec4 matter;
    double length;
    glm::dvec3 ray;
    hbEmissionAbsorption* light;
  };

  const hbScene& scene_;
  const hbMatter& matter_;
  hbCentralDifferences differences_;
  glm::dmat4 cubeToWorld_;
  std::vector<Piece> waiting_;
  std::vector<glm::dvec3> places_;
};
