#include "report/hbHardCaseValues.h"

#include <algorithm>
#include <cmath>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbOglPointBounds.h"
#include "glcombine/hbOglPoints.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "glcombine/hbOglSparseGrid.h"
#include "glcombine/hbOglTiles.h"
#include "sparsegrid/hbSemiNodalGrid.h"

namespace {

using Engine = hbHardCaseWay::Engine;
using Patch = hbHardCase::Patch;

/// Pixels are points of a plane across z.
hbOglSparseGrid::Plane planeOf(const Patch& patch, int index) {
  hbOglSparseGrid::Plane plane;
  plane.right.x = patch.step.x;
  plane.down.y = patch.step.y;
  plane.corner = patch.first - 0.5 * (plane.right + plane.down);
  plane.corner.z = patch.first.z + index * patch.step.z;
  plane.window = {0, 0, patch.count.x, patch.count.y};
  return plane;
}

} // namespace

hbHardCaseValues::hbHardCaseValues(const hbHardCase::Problem& problem, const hbSparseGrid* evaluated)
    : hbHardCaseMeasurement(problem, evaluated), combination_(problem.grid), bounds_(problem.grid, combination_) {
  for (const Patch& patch : problem.patches)
    for (const double z : patch.along(2))
      for (const double y : patch.along(1))
        for (const double x : patch.along(0)) {
          points_.emplace_back(x, y, z);
          x_.push_back(float(x));
          y_.push_back(float(y));
          z_.push_back(float(z));
          exact_.push_back(problem.grid.calcValue(points_.back(), 0));
        }
}

double hbHardCaseValues::range() const {
  const auto [least, greatest] = std::minmax_element(exact_.begin(), exact_.end());
  return problem_.grid.valueMap().scale * rangeOf(*least, *greatest);
}

hbHardCaseMeasurement::Amplification hbHardCaseValues::amplification() const {
  Amplification most;
  for (const glm::dvec3& point : points_) {
    double sum = 0.0;
    for (const hbComponentValue& one : hb::componentValues(combination_, point))
      sum += std::abs(one.grid->coefficient * one.value);
    most.combination = std::max(most.combination, sum);
    most.hierarchical = std::max(most.hierarchical, bounds_.magnitudes(point).weighted);
  }
  const double scale = problem_.grid.valueMap().scale / range();
  return {most.hierarchical * scale, most.combination * scale};
}

std::vector<double> hbHardCaseValues::atPoints(const hbField& field) const {
  std::vector<float> out(points_.size());
  field.values({x_, y_, z_}, 0, out);
  return {out.begin(), out.end()};
}

std::vector<double> hbHardCaseValues::onLattices() const {
  std::vector<double> all;
  for (const Patch& patch : problem_.patches) {
    std::vector<float> out(patch.points());
    const auto row = std::size_t(patch.count.x), plane = row * std::size_t(patch.count.y);
    evaluated_.lattice(patch.along(0), patch.along(1), patch.along(2), 0, out.data(), row, plane);
    all.insert(all.end(), out.begin(), out.end());
  }
  return all;
}

std::vector<double> hbHardCaseValues::onPlanes(const hbGlContext& context, hbGlFormat format) const {
  hbOglSparseGrid::Options options;
  options.textures = options.target = format;
  options.filter = hbOglSparseGrid::Filter::exact;
  const hbOglSparseGrid drawn(context, hbCombinationSparseGrid(evaluated_), 0, options);
  std::vector<double> all;
  for (const Patch& patch : problem_.patches) {
    const hbGlTarget target(context.gl(), patch.count.x, patch.count.y, format);
    for (int k = 0; k < patch.count.z; ++k) {
      const hbOglSparseGrid::Plane plane = planeOf(patch, k);
      drawn.draw({&plane, 1}, hbOglTiles(patch.count.x, patch.count.y, 1, std::max(patch.count.x, patch.count.y)),
                 target);
      std::vector<float> numbers;
      target.read(numbers);
      for (const float number : numbers) all.push_back(drawn.valueOf(double(number)));
    }
  }
  return all;
}

std::vector<double> hbHardCaseValues::byShader(const hbHardCaseWay& way, const hbGlContext& context) const {
  const hbOglValues values = way.engine == Engine::fused ? hbOglValues(context, hbCombinationSparseGrid(evaluated_), 0)
                                                         : hbOglValues(context, hbSemiNodalGrid(evaluated_), 0);
  std::vector<float> out(points_.size());
  hbOglPoints(context, values).values({x_, y_, z_}, out);
  return {out.begin(), out.end()};
}

std::vector<double> hbHardCaseValues::found(const hbHardCaseWay& way, const hbGlContext* context) const {
  switch (way.engine) {
  case Engine::direct:
    return atPoints(evaluated_);
  case Engine::seminodal:
    return atPoints(hbSemiNodalGrid(evaluated_));
  case Engine::combination:
    return atPoints(hbCombinationSparseGrid(evaluated_));
  case Engine::lattice:
    return onLattices();
  case Engine::blend:
    return onPlanes(*context, way.format);
  case Engine::fused:
  case Engine::oglSeminodal:
    return byShader(way, *context);
  case Engine::stored:
    break;
  }
  // The exact values of the surpluses in 64 bits.
  std::vector<double> values = exact_;
  const double scale = problem_.lost.valueMap().scale / problem_.grid.valueMap().scale;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += scale * problem_.lost.calcValue(points_[i], 0);
  return values;
}

std::vector<hbHardCaseError> hbHardCaseValues::errors(const hbHardCaseWay& way, const hbGlContext* context) const {
  const std::vector<double> values = found(way, context);
  const hbOglPointBounds device(bounds_);
  const auto bound = [&](const glm::dvec3& point) {
    switch (way.engine) {
    case Engine::direct:
      return bounds_.direct(point);
    case Engine::seminodal:
      return bounds_.semiNodal(point);
    case Engine::combination:
      return bounds_.combination(point);
    case Engine::lattice:
      return bounds_.lattice(point);
    case Engine::blend:
      return device.blend(point, way.format, glm::dvec3(hbOglRoundingBounds::kCoordinate));
    case Engine::fused:
      return device.fused(point);
    case Engine::oglSeminodal:
      return device.semiNodal(point);
    case Engine::stored:
      break;
    }
    return bounds_.stored(point);
  };
  const double scale = problem_.grid.valueMap().scale;
  std::vector<hbHardCaseError> list;
  for (std::size_t i = 0; i < points_.size(); ++i)
    list.push_back({scale * std::abs(values[i] - exact_[i]), scale * bound(points_[i])});
  return list;
}
