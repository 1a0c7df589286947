#include "raycast/hbSliceSampler.h"

#include <cmath>

hbSliceSampler::Rectangle hbSliceSampler::rectangle(int n, int v0, int v1) const {
  const hbShearFactorisation::Slice slice = rays_.slice(n);
  const auto u = hbShearFactorisation::inside(rays_.u(), slice.offsetU, slice.scale, rays_.faces(rays_.order().fast));
  const auto v = hbShearFactorisation::inside(rays_.v(), slice.offsetV, slice.scale, rays_.faces(rays_.order().row));
  return {u.first, u.second, std::max(v.first, v0), std::min(v.second, v1)};
}

hbSliceSampler::Rectangle hbSliceSampler::inner(int n, const Rectangle& r) const {
  // Rays begin at an orthographic camera's plane, wherever that is.
  if (n <= rays_.firstSlice() || n + 1 >= rays_.endSlice() || rays_.isPartlyBehind()) return {};
  const Rectangle both = rectangle(n - 1, r.v0, r.v1).intersect(rectangle(n + 1, r.v0, r.v1)).intersect(r);
  return both.isEmpty() ? Rectangle{} : both;
}

void hbSliceSampler::sample(int n, const Rectangle& r, Scratch& scratch, float hidden, float* out) const {
  const hbShearFactorisation::Slice slice = rays_.slice(n);
  scratch.us.resize(std::size_t(r.u1 - r.u0));
  scratch.vs.resize(std::size_t(r.v1 - r.v0));
  for (int i = r.u0; i < r.u1; ++i) scratch.us[std::size_t(i - r.u0)] = slice.offsetU + slice.scale * rays_.u().at(i);
  for (int j = r.v0; j < r.v1; ++j) scratch.vs[std::size_t(j - r.v0)] = slice.offsetV + slice.scale * rays_.v().at(j);
  evaluate(scratch.us, scratch.vs, slice.w, scratch.lattice, scratch, out);
  if (!rays_.isPartlyBehind()) return;
  for (int j = r.v0; j < r.v1; ++j)
    for (int i = r.u0; i < r.u1; ++i)
      if (n < rays_.placeInFront(rays_.u().at(i), rays_.v().at(j)))
        out[std::size_t(i - r.u0) + std::size_t(rays_.u().count) * std::size_t(j - r.v0)] = hidden;
}

void hbSliceSampler::evaluate(std::span<const double> us, std::span<const double> vs, double w, Lattice& lattice,
                              Scratch& scratch, float* out) const {
  // Along an axis all slices are sampled at the same places.
  if (!std::ranges::equal(us, lattice.us) || !std::ranges::equal(vs, lattice.vs)) {
    lattice.plan.emplace(source_.components.front().plan(us, vs));
    lattice.us.assign(us.begin(), us.end());
    lattice.vs.assign(vs.begin(), vs.end());
  }
  if (source_.magnitude)
    lengths(w, lattice, scratch, out);
  else
    source_.components.front().plane(*lattice.plan, w, scratch.workspace, out, std::size_t(rays_.u().count));
}

void hbSliceSampler::lengths(double w, const Lattice& lattice, Scratch& scratch, float* out) const {
  const std::size_t columns = lattice.us.size(), rows = lattice.vs.size();
  scratch.squares.assign(columns * rows, 0.0);
  scratch.component.resize(columns * rows);
  for (const hbLatticeEvaluator& evaluator : source_.components) {
    evaluator.plane(*lattice.plan, w, scratch.workspace, scratch.component.data(), columns);
    for (std::size_t k = 0; k < scratch.squares.size(); ++k) {
      const double value = source_.map.toTrue(scratch.component[k]);
      scratch.squares[k] += value * value;
    }
  }
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i)
      out[i + std::size_t(rays_.u().count) * j] = float(std::sqrt(scratch.squares[i + columns * j]));
}
