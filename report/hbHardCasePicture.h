#pragma once

#include <utility>

#include "raycast/hbPlaneRays.h"
#include "report/hbHardCaseMeasurement.h"
#include "scene/hbPicture.h"
#include "sparsegrid/hbPointBounds.h"

class hbOglPointBounds;

/// Of a picture: X-rays against sums of the same samples in 64 bits. Those of `lattice` lie on slices, and are
/// hbShearReference's.
///
/// An iso-surface may be there or not for the last bit of a value, so no distance between two surfaces says anything.
/// What is measured is how far the samples along a ray would have to be off for the surface to be where it was found:
/// the error of a value again (Wilkinson's backward error). Rays of all ways go through the same samples, `lattice`'s
/// too as long as the view is parallel and along an axis. Field values are true ones (no value map).
class hbHardCasePicture final : public hbHardCaseMeasurement {
public:
  explicit hbHardCasePicture(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated = nullptr);

  std::vector<hbHardCaseError> errors(const hbHardCaseWay& way, const hbGlContext* context) const override;
  double range() const override;
  Amplification amplification() const override;

private:
  struct Sample {
    glm::dvec3 point{0.0};
    double value = 0.0;
  };
  hbPicture drawn(const hbHardCaseWay& way, const hbGlContext* context) const;
  double boundAt(const hbHardCaseWay& way, const hbOglPointBounds& device, const glm::dvec3& point,
                 const glm::dvec3& off) const;
  glm::dvec3 shaderOff(std::size_t pixel, int plane) const;
  std::vector<std::vector<double>> sampleBounds(const hbHardCaseWay& way) const;
  static double sumBound(const hbHardCaseWay& way, double samples, double magnitude);
  std::vector<hbHardCaseError> xrayErrors(const hbHardCaseWay& way, const hbPicture& picture) const;
  std::vector<hbHardCaseError> shearErrors(const hbPicture& picture) const;
  std::vector<hbHardCaseError> isoErrors(const hbHardCaseWay& way, const hbPicture& picture) const;
  std::vector<hbHardCaseError> storedErrors() const;
  std::pair<double, double> extremes() const;
  double weight(std::size_t pixel) const { return rays_.step() / rays_.rays()[pixel].cosine; }

  hbCombinationSparseGrid combination_;
  hbPointBounds bounds_;
  hbPlaneRays rays_;
  glm::dvec3 slopes_;
  double reach_ = 1.0;                       ///< Largest coordinate of a plane's corner in the cube.
  std::vector<std::vector<Sample>> samples_; ///< Of each pixel, from its first plane on.
};
