#pragma once

#include "report/hbHardCaseMeasurement.h"
#include "sparsegrid/hbPointBounds.h"
#include "volume/hbField.h"

/// Of the values at the points of the problem's patches, which every way is asked for: as points, as a lattice, or as
/// planes.
class hbHardCaseValues final : public hbHardCaseMeasurement {
public:
  explicit hbHardCaseValues(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated = nullptr);

  std::vector<hbHardCaseError> errors(const hbHardCaseWay& way, const hbGlContext* context) const override;
  double range() const override;
  Amplification amplification() const override;

private:
  std::vector<double> found(const hbHardCaseWay& way, const hbGlContext* context) const;
  std::vector<double> atPoints(const hbField& field) const;
  std::vector<double> onLattices() const;
  std::vector<double> onPlanes(const hbGlContext& context, hbGlFormat format) const;
  std::vector<double> byShader(const hbHardCaseWay& way, const hbGlContext& context) const;

  hbCombinationSparseGrid combination_;
  hbPointBounds bounds_;
  std::vector<glm::dvec3> points_; ///< Of all patches, x fastest.
  std::vector<float> x_, y_, z_;   ///< The same.
  std::vector<double> exact_;      ///< Field values.
};
