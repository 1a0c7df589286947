#include "raycast/hbRayChords.h"

#include <algorithm>
#include <cmath>
#include <limits>

hbRayChords::hbRayChords(const hbShearFactorisation& rays)
    : rays_(rays), u_(runs(false)), v_(runs(true)), start_(std::max(rays.frontPlace(), rays.eyePlace())) {}

/// A coordinate of a ray changes in one direction from slice to slice, in rounded numbers, too: it lies in the box in
/// an unbroken run of slices.
hbRayChords::Runs hbRayChords::runs(bool alongV) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const hbShearFactorisation::Axis& axis = alongV ? rays_.v() : rays_.u();
  const hbShearFactorisation::Faces box = rays_.faces(alongV ? rays_.order().row : rays_.order().fast);
  const auto count = std::size_t(axis.count);
  Runs list{std::vector<int>(count), std::vector<int>(count), std::vector<double>(count, -kInfinity),
            std::vector<double>(count, kInfinity)};
  std::pair<int, int> before{0, 0};
  for (int n = rays_.firstSlice(); n < rays_.endSlice(); ++n) {
    const hbShearFactorisation::Slice slice = rays_.slice(n);
    const auto now = hbShearFactorisation::inside(axis, alongV ? slice.offsetV : slice.offsetU, slice.scale, box);
    const auto start = [&](int from, int to) {
      for (int i = from; i < to; ++i) list.first[std::size_t(i)] = n;
    };
    const auto stop = [&](int from, int to) {
      for (int i = from; i < to; ++i) list.end[std::size_t(i)] = n;
    };
    start(now.first, std::min(now.second, before.first));
    start(std::max(now.first, before.second), now.second);
    stop(before.first, std::min(before.second, now.first));
    stop(std::max(before.first, now.second), before.second);
    before = now;
  }
  for (int i = before.first; i < before.second; ++i) list.end[std::size_t(i)] = rays_.endSlice();

  const hbShearFactorisation::Slice slice = rays_.slice(rays_.firstSlice()), change = rays_.changeOfSlice();
  for (int i = 0; i < axis.count; ++i) {
    const double at = (alongV ? slice.offsetV : slice.offsetU) + slice.scale * axis.at(i);
    const double rate = (alongV ? change.offsetV : change.offsetU) + change.scale * axis.at(i);
    if (rate == 0.0) continue;
    const double a = rays_.firstSlice() + (box.lo - at) / rate, b = rays_.firstSlice() + (box.hi - at) / rate;
    list.enter[std::size_t(i)] = std::min(a, b);
    list.leave[std::size_t(i)] = std::max(a, b);
  }
  return list;
}

hbRayChords::Chord hbRayChords::at(int i, int j) const {
  const auto u = std::size_t(i), v = std::size_t(j);
  Chord chord{std::max(u_.first[u], v_.first[v]), std::min(u_.end[u], v_.end[v]) - 1, 0.0, 0.0};
  double start = start_;
  if (rays_.isPartlyBehind()) {
    start = std::max(start, rays_.placeInFront(rays_.u().at(i), rays_.v().at(j)));
    chord.first = std::max(chord.first, int(std::ceil(std::min(start, double(rays_.slices())))));
  }
  const double end = rays_.backPlace();
  chord.before = std::clamp(chord.first - std::max({start, u_.enter[u], v_.enter[v]}), 0.0, 1.0);
  chord.after = std::clamp(std::min({end, u_.leave[u], v_.leave[v]}) - chord.last, 0.0, 1.0);
  return chord;
}
