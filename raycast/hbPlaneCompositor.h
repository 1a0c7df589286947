#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "raycast/hbPlaneRays.h"

class hbLitPieces;

/// Pictures from whole planes of samples that somebody else evaluates: planewise sampling, turned inside out. What
/// hbRaycaster does along a ray, plane by plane for all rays: X-ray sums, MIP takes the greatest value, an iso-surface
/// lies between two planes, linearly interpolated, and DVR composites front to back in 64 bits, lit as hbRaycaster
/// does.
///
/// Source: the sparse-grid paper, section 4 and Fig. 5, and draw of section 6.
class hbPlaneCompositor {
public:
  /// Keeps a reference to `rays`, whose field gives the gradients by which pictures are shaded, and is seen where
  /// DVR has no plane.
  explicit hbPlaneCompositor(const hbPlaneRays& rays);
  ~hbPlaneCompositor();

  /// Takes the field values of a plane, width * height, the top row first; planes in order, from 0 on. Values of
  /// samples outside the volume do not matter.
  void add(int index, std::span<const float> values);

  /// The picture, with the channels and the metadata of hbRaycaster::render().
  hbPicture finish() const;

private:
  std::vector<hbPlaneRays::Surface> shaded() const;
  void composite(std::size_t pixel, int index, float value);
  void addPiece(std::size_t pixel, const glm::vec4& piece, double length, double place);

  const hbPlaneRays& rays_;
  int added_ = 0;
  std::vector<double> sums_;    ///< X-ray.
  std::vector<float> greatest_; ///< MIP; iso, DVR: of the plane before.
  std::vector<hbPlaneRays::Surface> crossings_;
  std::vector<bool> isFound_;
  std::optional<hbMatter> matter_; ///< DVR.
  std::vector<hbEmissionAbsorption> lights_;
  std::unique_ptr<hbLitPieces> lit_; ///< DVR by gradients: of one plane.
};
