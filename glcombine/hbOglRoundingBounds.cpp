#include "glcombine/hbOglRoundingBounds.h"

#include <algorithm>
#include <cmath>

#include "sparsegrid/hbRoundingBounds.h"

hbOglRoundingBounds::hbOglRoundingBounds(const hbCombinationSparseGrid& grid, int component) {
  for (const auto& one : grid.grids()) {
    for (const float value : grid.values(one, component)) largest_ = std::max(largest_, double(std::abs(value)));
    weights_ += std::abs(one.coefficient);
    ++terms_;
    for (int d = 0; d < 3; ++d) steepness_ += std::abs(one.coefficient) * 2.0 * std::exp2(one.levels[d]);
  }
  steepness_ *= largest_;
}

hbOglRoundingBounds::hbOglRoundingBounds(const hbCombinationSparseGrid& grid, const hbPlaneRays& rays)
    : hbOglRoundingBounds(grid, rays.scene().component) {
  planes_ = rays.planes();
  for (const int i : {0, rays.planes() - 1}) {
    const hbPlaneRays::Plane plane = rays.plane(i);
    for (const double x : {0.0, double(rays.scene().width)})
      for (const double y : {0.0, double(rays.scene().height)})
        for (int d = 0; d < 3; ++d)
          reach_ = std::max(reach_, std::abs(plane.corner[d] + x * plane.right[d] + y * plane.down[d]));
  }
}

double hbOglRoundingBounds::floats() const {
  return (hb::kCombinationRoundings + terms_) * 0x1p-24 * weights_ * largest_ + kCoordinate * reach_ * steepness_;
}

hbOglRoundingBounds& hbOglRoundingBounds::withTexels(double rounding) {
  texels_ = rounding * 2.0 * largest_ * weights_;
  return *this;
}

double hb::oglCombinationBound(const hbSparseGrid& grid, int component) {
  double largest = 0.0;
  for (const double value : grid.nodalValues(component)) largest = std::max(largest, std::abs(value));
  return combinationBound(grid.indexSet(), largest) +
         double(grid.indexSet().componentGrids().size()) * 0x1p-24 * amplification(grid.indexSet()) * largest +
         coordinateBound(grid, component);
}

double hb::oglSemiNodalBound(const hbSparseGrid& grid, int component) {
  return semiNodalBound(grid, component) + kOglSemiNodalMore * 0x1p-24 * amplitude(grid, component);
}
