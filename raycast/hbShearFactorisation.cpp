#include "raycast/hbShearFactorisation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "raycast/hbOutline.h"

namespace {

/// A whole number of steps should not become one more by rounding: about ten operations in 64 bits.
constexpr double kRounding = 1e-14;

/// More rays than this along an axis no picture needs.
constexpr double kMostRays = 1 << 28;

} // namespace

int hbShearFactorisation::mainDirection(const glm::dvec3& scaled) {
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (std::abs(scaled[d]) > std::abs(scaled[axis])) axis = d;
  return 2 * axis + (scaled[axis] < 0.0 ? 1 : 0);
}

int hbShearFactorisation::directionOf(double px, double py) const {
  const glm::dvec3 scaled = rays_->direction(px, py) * edges_;
  const int axis = viewDirection_ / 2;
  const double along = viewDirection_ % 2 == 0 ? scaled[axis] : -scaled[axis];
  const double across = std::max(std::abs(scaled[(axis + 1) % 3]), std::abs(scaled[(axis + 2) % 3]));
  return along > 0.0 && across <= kSteepest * along ? viewDirection_ : mainDirection(scaled);
}

hbShearFactorisation::hbShearFactorisation(const hbScene& scene, const hbGeometry& geometry, const hbPixelRays& rays,
                                           int direction)
    : rays_(&rays), edges_(geometry.extent()), direction_(direction),
      perspective_(scene.camera->projection == hbCamera::Projection::perspective) {
  const glm::dvec3 middle = rays.direction(0.5 * rays.width(), 0.5 * rays.height());
  viewDirection_ = mainDirection(middle * edges_);
  if (direction_ == kOfTheView) direction_ = viewDirection_;
  sign_ = direction_ % 2 == 0 ? 1.0 : -1.0;
  const int w = direction_ / 2, u = w == 0 ? 1 : 0, v = w == 2 ? 1 : 2;
  order_ = {u, v, w};

  // The rays' affine maps at three corners of a pixel, as the columns of one map to homogeneous base coordinates.
  const auto homogeneous = [&](const glm::dvec3& origin, const glm::dvec3& ray) {
    if (perspective_) return glm::dvec3(ray[u], ray[v], sign_ * ray[w]);
    return glm::dvec3(origin[u] + (0.5 - origin[w]) * slope_.x, origin[v] + (0.5 - origin[w]) * slope_.y, 1.0);
  };
  eye_ = rays.origin(0.0, 0.0);
  if (!perspective_) slope_ = {middle[u] / middle[w], middle[v] / middle[w]};
  const glm::dvec3 corner = homogeneous(rays.origin(0.0, 0.0), rays.direction(0.0, 0.0));
  toBase_ = glm::dmat3(corner, homogeneous(rays.origin(1.0, 0.0), rays.direction(1.0, 0.0)) - corner,
                       homogeneous(rays.origin(0.0, 1.0), rays.direction(0.0, 1.0)) - corner);
  placeSlices(scene, geometry);
}

void hbShearFactorisation::placeSlices(const hbScene& scene, const hbGeometry& geometry) {
  const int w = order_.plane;
  const double step = scene.sampling.stepLength(geometry, *scene.camera);
  // Along the view axis through one slab, or, for directions beside it, straight through.
  const glm::dvec3 middle = rays_->direction(0.5 * rays_->width(), 0.5 * rays_->height());
  const double depth = direction_ == viewDirection_ ? 1.0 / std::abs(middle[w]) : edges_[w];
  slices_ = int(std::clamp(std::ceil(depth / step * (1.0 - kRounding)), 1.0, double(hbSampling::kMaxSamples)));
  endSlice_ = slices_;
  const auto isShown = [&](int n) {
    const double at = slice(n).w;
    return at >= faces(w).lo && at <= faces(w).hi && (!perspective_ || sign_ * (at - eye_[w]) > 0.0);
  };
  while (firstSlice_ < endSlice_ && !isShown(firstSlice_)) ++firstSlice_;
  while (firstSlice_ < endSlice_ && !isShown(endSlice_ - 1)) --endSlice_;
}

hbShearFactorisation::Slice hbShearFactorisation::slice(double n) const {
  const double w = (sign_ > 0.0 ? n + 0.5 : slices_ - n - 0.5) / slices_;
  if (perspective_) return {w, eye_[order_.fast], eye_[order_.row], std::abs(w - eye_[order_.plane])};
  return {w, (w - 0.5) * slope_.x, (w - 0.5) * slope_.y, 1.0};
}

hbShearFactorisation::Slice hbShearFactorisation::changeOfSlice() const {
  const double w = sign_ / slices_;
  if (perspective_) return {w, 0.0, 0.0, 1.0 / slices_};
  return {w, w * slope_.x, w * slope_.y, 0.0};
}

double hbShearFactorisation::eyePlace() const {
  if (!perspective_) return -std::numeric_limits<double>::infinity();
  return placeOf(eye_[order_.plane]);
}

double hbShearFactorisation::placeInFront(double a, double b) const {
  const Slice first = slice(0), change = changeOfSlice();
  const double before = rays_->distance(point(first, a, b));
  const Slice second{first.w + change.w, first.offsetU + change.offsetU, first.offsetV + change.offsetV, first.scale};
  return -before / (rays_->distance(point(second, a, b)) - before);
}

glm::dvec3 hbShearFactorisation::point(const Slice& slice, double a, double b) const {
  glm::dvec3 p;
  p[order_.fast] = slice.offsetU + slice.scale * a;
  p[order_.row] = slice.offsetV + slice.scale * b;
  p[order_.plane] = slice.w;
  return p;
}

glm::dvec2 hbShearFactorisation::base(double px, double py) const {
  const glm::dvec3 h = toBase_[0] + px * toBase_[1] + py * toBase_[2];
  return glm::dvec2(h) / h.z;
}

hbShearFactorisation::Neighbours hbShearFactorisation::neighbours(double px, double py) const {
  // Along either axis: the nearer lower ray and the share of the next; a pixel on a ray but for rounding is on it.
  struct Between {
    int lower = 0;
    std::array<double, 2> share{0.0, 0.0};
  };
  const auto split = [](const Axis& axis, double coordinate) {
    constexpr double kOnRay = 1e-9;
    const double place = axis.place(coordinate);
    if (!(place > -1.0 && place < axis.count)) return Between{}; // a step or more beside all rays
    const int lower = int(place + (1.0 + kOnRay)) - 1;
    const double upper = place - lower < kOnRay ? 0.0 : place - lower;
    return Between{lower, {1.0 - upper, upper}};
  };
  const glm::dvec2 coordinates = base(px, py);
  const Between u = split(u_, coordinates.x), v = split(v_, coordinates.y);
  Neighbours found;
  for (int dj = 0; dj < 2; ++dj)
    for (int di = 0; di < 2; ++di) {
      const int i = u.lower + di, j = v.lower + dj;
      const double weight = u.share[std::size_t(di)] * v.share[std::size_t(dj)];
      if (weight == 0.0 || i < 0 || i >= u_.count || j < 0 || j >= v_.count) continue;
      found.at[std::size_t(found.count)] = std::size_t(i) + std::size_t(u_.count) * std::size_t(j);
      found.weight[std::size_t(found.count++)] = weight;
    }
  return found;
}

std::pair<int, int> hbShearFactorisation::inside(const Axis& axis, double offset, double scale, const Faces& faces) {
  const auto at = [&](int i) { return offset + scale * axis.at(i); };
  const auto near = [&](double face) {
    return int(std::clamp(std::floor(axis.place((face - offset) / scale)), 0.0, double(axis.count)));
  };
  int first = near(faces.lo), last = near(faces.hi);
  while (first > 0 && at(first - 1) >= faces.lo) --first;
  while (first < axis.count && at(first) < faces.lo) ++first;
  while (last > 0 && at(last - 1) > faces.hi) --last;
  while (last < axis.count && at(last) <= faces.hi) ++last;
  return {first, std::max(first, last)};
}

void hbShearFactorisation::reach(double px, double py) {
  const glm::dvec3 h = toBase_ * glm::dvec3(1.0, px, py);
  reach_.least = glm::min(reach_.least, glm::dvec2(h) / h.z);
  reach_.most = glm::max(reach_.most, glm::dvec2(h) / h.z);
  reach_.nearest = std::max(reach_.nearest, h.z);
  reach_.steepest.x = std::max(reach_.steepest.x, glm::length(h.z * gradient(1) - h.y * gradient(2)));
  reach_.steepest.y = std::max(reach_.steepest.y, glm::length(h.z * gradient(0) - h.x * gradient(2)));
}

// Pixels have the homogeneous base coordinates (a m, b m, m) = toBase_ (1, px, py). A change of a moves a ray in the
// picture by |dp/da| = m |m grad(b m) - b m grad m| / |det toBase_|, and one of b likewise. Steps of 1 / (supersample
// |dp/da|) are wanted, at most; where m or the slopes change over the picture there are two ways to have them.

/// By the greatest m and the greatest vector: both are affine in the pixel, neither is greater than at the corners.
hbShearFactorisation::Axis hbShearFactorisation::equalSteps(int d, int supersample) const {
  const double step = std::abs(glm::determinant(toBase_)) / (reach_.nearest * reach_.steepest[d]) / supersample;
  const double last = std::ceil((reach_.most[d] - reach_.least[d]) / step - 1e-9);
  return {reach_.least[d], step, 0.0, int(std::min(last, kMostRays)) + 1};
}

/// With the vector divided by m, |dp/da| = m^2 |grad(b m) - b grad m| / |det|, and 1/m is affine in a and b. Taking the
/// extremes over b, it is at most vector / (|det| D(a)^2) with an affine D, so the step D(a)^2 |det| / (supersample
/// vector) does, which is that of a projected row. No such row where D has a zero.
hbShearFactorisation::Axis hbShearFactorisation::projectedSteps(int d, int supersample) const {
  const int other = 1 - d;
  const glm::dmat3 inverse = glm::inverse(toBase_);
  const double lo = reach_.least[d], hi = reach_.most[d];
  double vector = 0.0, least = std::numeric_limits<double>::infinity();
  for (const double b : {reach_.least[other], reach_.most[other]}) {
    vector = std::max(vector, glm::length(gradient(other) - b * gradient(2)));
    least = std::min(least, inverse[other][0] * b);
  }
  const double slope = inverse[d][0], start = inverse[2][0] + least + slope * lo,
               end = inverse[2][0] + least + slope * hi;
  if (!(start > 0.0 && end > 0.0)) return {lo, hi - lo, 0.0, std::numeric_limits<int>::max()};
  const double density = std::abs(glm::determinant(toBase_)) / (vector * supersample);
  Axis axis{lo, start * start * density, -start * slope * density, 0};
  // The last ray is the end itself: one beyond it could lie beyond the row's pole.
  const double place = axis.place(hi), last = std::max(1.0, std::ceil(place - 1e-9));
  if (!(place > 0.0 && last < kMostRays)) return {lo, hi - lo, 0.0, std::numeric_limits<int>::max()};
  axis.step *= place / last;
  axis.bend *= place / last;
  axis.count = int(last) + 1;
  return axis;
}

hbShearFactorisation::Axis hbShearFactorisation::Axis::from(double place, int newCount) const {
  // at(p + k) - at(p) = k step / ((1 + bend p) (1 + bend p + bend k))
  const double scale = 1.0 / (1.0 + bend * place);
  return {first + place * step * scale, step * scale * scale, bend * scale, newCount};
}

/// As far as any slice reaches.
hbShearFactorisation::Axis hbShearFactorisation::cut(const Axis& axis, bool alongV) const {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  const Faces box = faces(alongV ? order_.row : order_.fast);
  for (int n = firstSlice_; n < endSlice_; ++n) {
    const Slice s = slice(n);
    const double offset = alongV ? s.offsetV : s.offsetU;
    lo = std::min(lo, (box.lo - offset) / s.scale);
    hi = std::max(hi, (box.hi - offset) / s.scale);
  }
  const double last = axis.at(axis.count - 1);
  if (!(lo <= last && hi >= axis.first)) return axis.from(0, 0);
  const double first = lo > axis.first ? std::floor(axis.place(lo)) : 0.0;
  const double end = hi < last ? std::min(axis.count - 1.0, std::ceil(axis.place(hi))) : axis.count - 1.0;
  return axis.from(first, int(end - first) + 1);
}

/// Moved by less than a step, so that the first pixel's own ray is one of them.
hbShearFactorisation::Axis hbShearFactorisation::onPixels(const Axis& axis, int d) const {
  const glm::dvec3 h = toBase_ * glm::dvec3(1.0, 0.5, 0.5);
  const double place = axis.place(h[d] / h.z);
  if (!(h.z > 0.0 && 1.0 + axis.bend * place > 0.0)) return axis;
  const double before = place - std::floor(place) - 1.0;
  // A projected row must not be moved over its pole.
  const bool isWhole = 1.0 + axis.bend * before > 0.0 && 1.0 + axis.bend * (before + axis.count) > 0.0;
  return isWhole ? axis.from(before, axis.count + 1) : axis;
}

void hbShearFactorisation::placeRays(int supersample) {
  if (!(reach_.nearest > 0.0)) return;
  for (int d = 0; d < 2; ++d) {
    const Axis equal = equalSteps(d, supersample), projected = projectedSteps(d, supersample);
    (d == 0 ? u_ : v_) = cut(onPixels(projected.count < equal.count ? projected : equal, d), d == 1);
  }
  if (perspective_ || isEmpty()) return;
  const auto& [lo, hi] = rays_->box();
  for (const double x : {lo.x, hi.x})
    for (const double y : {lo.y, hi.y})
      for (const double z : {lo.z, hi.z}) partlyBehind_ = partlyBehind_ || rays_->distance({x, y, z}) < 0.0;
}

std::vector<hbShearFactorisation> hbShearFactorisation::of(const hbScene& scene, const hbGeometry& geometry,
                                                           const hbPixelRays& rays, int supersample) {
  hbShearFactorisation main(scene, geometry, rays, kOfTheView);
  // The rays that keep the view axis' direction form a convex cone: it holds what is seen if it holds the outline.
  const std::vector<glm::dvec2> outline = hb::outline(rays);
  main.all_ = std::all_of(outline.begin(), outline.end(),
                          [&](const glm::dvec2& p) { return main.directionOf(p.x, p.y) == main.viewDirection_; });
  if (main.all_) {
    for (const glm::dvec2& p : outline) main.reach(p.x, p.y);
    main.placeRays(supersample);
    return {main};
  }
  std::vector<hbShearFactorisation> six, used;
  for (int direction = 0; direction < 6; ++direction) six.push_back({scene, geometry, rays, direction});
  for (int y = 0; y < rays.height(); ++y)
    for (int x = 0; x < rays.width(); ++x)
      if (rays.clip(x + 0.5, y + 0.5)) six[std::size_t(main.directionOf(x + 0.5, y + 0.5))].reach(x + 0.5, y + 0.5);
  for (hbShearFactorisation& one : six) {
    one.placeRays(supersample);
    if (one.reach_.nearest > 0.0) used.push_back(one);
  }
  return used;
}
