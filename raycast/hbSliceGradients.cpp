#include "raycast/hbSliceGradients.h"

#include <algorithm>

#include <glm/matrix.hpp>

namespace {

/// Places moved along an axis of the cube, and no farther than its faces.
std::vector<double> moved(std::vector<double> places, double way) {
  for (double& place : places) place = std::clamp(place + way, 0.0, 1.0);
  return places;
}

} // namespace

void hbSliceGradients::Scratch::restart() {
  here.restart();
  for (hbSliceSampler::Lattice& lattice : beside) lattice.restart();
}

hbSliceGradients::hbSliceGradients(const hbShearFactorisation& rays, const hbSliceSampler& sampler,
                                   const hbGeometry& geometry)
    : rays_(rays), sampler_(sampler), spacing_(geometry.cubeSpacing()),
      toWorld_(glm::transpose(glm::dmat3(glm::inverse(geometry.cubeToWorld())))) {
  for (int d = 0; d < 3; ++d)
    if (geometry.isFlat(d)) spacing_[d] = 0.0;
}

void hbSliceGradients::evaluate(double place, const hbSliceSampler::Rectangle& r, Scratch& scratch) const {
  const hbShearFactorisation::Slice slice = rays_.slice(place);
  const double w = std::clamp(slice.w, 0.0, 1.0);
  scratch.us.resize(std::size_t(r.u1 - r.u0));
  scratch.vs.resize(std::size_t(r.v1 - r.v0));
  for (int i = r.u0; i < r.u1; ++i)
    scratch.us[std::size_t(i - r.u0)] = std::clamp(slice.offsetU + slice.scale * rays_.u().at(i), 0.0, 1.0);
  for (int j = r.v0; j < r.v1; ++j)
    scratch.vs[std::size_t(j - r.v0)] = std::clamp(slice.offsetV + slice.scale * rays_.v().at(j), 0.0, 1.0);

  const auto stride = std::size_t(rays_.u().count);
  const std::size_t size = stride * scratch.vs.size();
  const hbAxisOrder& order = rays_.order();
  if (scratch.lower.size() < size) scratch.lower.resize(size);
  // slope = (upper - lower) / span, span(i, j) the distance between the two.
  const auto divide = [&](std::vector<float>& slope, const auto& span) {
    for (std::size_t j = 0; j < scratch.vs.size(); ++j)
      for (std::size_t i = 0; i < scratch.us.size(); ++i) {
        const std::size_t at = i + stride * j;
        slope[at] = float((double(slope[at]) - double(scratch.lower[at])) / span(i, j));
      }
  };
  const auto ready = [&](int axis) {
    std::vector<float>& slope = scratch.slopes[std::size_t(axis)];
    if (slope.size() < size) slope.resize(size);
    if (spacing_[axis] > 0.0) return true;
    std::fill(slope.begin(), slope.end(), 0.0F);
    return false;
  };
  if (ready(order.fast)) {
    const double h = spacing_[order.fast];
    std::vector<float>& slope = scratch.slopes[std::size_t(order.fast)];
    const std::vector<double> lower = moved(scratch.us, -h), upper = moved(scratch.us, h);
    sampler_.evaluate(lower, scratch.vs, w, scratch.beside[0], scratch.sampler, scratch.lower.data());
    sampler_.evaluate(upper, scratch.vs, w, scratch.beside[1], scratch.sampler, slope.data());
    divide(slope, [&](std::size_t i, std::size_t) { return upper[i] - lower[i]; });
  }
  if (ready(order.row)) {
    const double h = spacing_[order.row];
    std::vector<float>& slope = scratch.slopes[std::size_t(order.row)];
    const std::vector<double> lower = moved(scratch.vs, -h), upper = moved(scratch.vs, h);
    sampler_.evaluate(scratch.us, lower, w, scratch.beside[2], scratch.sampler, scratch.lower.data());
    sampler_.evaluate(scratch.us, upper, w, scratch.beside[3], scratch.sampler, slope.data());
    divide(slope, [&](std::size_t, std::size_t j) { return upper[j] - lower[j]; });
  }
  if (ready(order.plane)) {
    const double h = spacing_[order.plane], lower = std::max(0.0, w - h), upper = std::min(1.0, w + h);
    std::vector<float>& slope = scratch.slopes[std::size_t(order.plane)];
    sampler_.evaluate(scratch.us, scratch.vs, lower, scratch.here, scratch.sampler, scratch.lower.data());
    sampler_.evaluate(scratch.us, scratch.vs, upper, scratch.here, scratch.sampler, slope.data());
    divide(slope, [&](std::size_t, std::size_t) { return upper - lower; });
  }
}
