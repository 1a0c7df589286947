#include "scene/hbTransferFunction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene/hbColorSpace.h"
#include "volume/hbError.h"

namespace {

using Definition = hbTransferFunction::Definition;
using ColorSpace = hbTransferFunction::ColorSpace;
using OpacityPoint = hbTransferFunction::OpacityPoint;

// Volumes have such values. Differences of two of them are far from overflow in 64 bits.
constexpr double kMaxValue = std::numeric_limits<float>::max();
constexpr double kLeastWidth = std::numeric_limits<float>::denorm_min();

template <class Point>
void checkValues(const std::vector<Point>& points, const std::string& place) {
  if (points.size() > hbTransferFunction::kMaxPoints)
    throw hbError(
        fmt::format("{}: expected at most {} points, found {}", place, hbTransferFunction::kMaxPoints, points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double value = points[i].value;
    if (!(std::abs(value) <= kMaxValue))
      throw hbError(
          fmt::format("{}: point {}: expected a value in the range of 32-bit floats, found {}", place, i + 1, value));
    if (i > 0 && value < points[i - 1].value)
      throw hbError(fmt::format("{}: point {}: expected a value of at least {}, that of the point before, found {}",
                                place, i + 1, points[i - 1].value, value));
  }
}

void checkFraction(double x, const std::string& place, std::string_view member) {
  if (!(x >= 0.0 && x <= 1.0)) throw hbError(fmt::format("{}: expected {} in [0,1], found {}", place, member, x));
}

void checkColour(const glm::dvec3& rgb, const std::string& place) {
  for (int c = 0; c < 3; ++c) checkFraction(rgb[c], place, "channels");
}

void check(const Definition& d, const std::string& what) {
  if (d.name.size() > hbTransferFunction::kMaxNameLength)
    throw hbError(fmt::format("{}: Name: expected at most {} bytes, found {}", what, hbTransferFunction::kMaxNameLength,
                              d.name.size()));
  const std::string colors = what + ": RGBPoints", opacities = what + ": Points";
  if (d.colors.empty()) throw hbError(colors + ": expected at least one point, found none");
  checkValues(d.colors, colors);
  checkValues(d.opacities, opacities);
  for (std::size_t i = 0; i < d.colors.size(); ++i)
    checkColour(d.colors[i].rgb, fmt::format("{}: point {}", colors, i + 1));
  for (std::size_t i = 0; i < d.opacities.size(); ++i) {
    const std::string place = fmt::format("{}: point {}", opacities, i + 1);
    checkFraction(d.opacities[i].opacity, place, "an opacity");
    checkFraction(d.opacities[i].midpoint, place, "a midpoint");
    checkFraction(d.opacities[i].sharpness, place, "a sharpness");
  }
  if (d.belowColor) checkColour(*d.belowColor, what + ": BelowRangeColor");
  if (d.aboveColor) checkColour(*d.aboveColor, what + ": AboveRangeColor");
  checkColour(d.nanColor, what + ": NanColor");
  checkFraction(d.nanOpacity, what + ": NanOpacity", "a number");
  if (d.unitLength && !(*d.unitLength >= 1e-80 && *d.unitLength <= 1e80))
    throw hbError(fmt::format("{}: ScalarOpacityUnitDistance: expected a length from 1e-80 to 1e80, found {}", what,
                              *d.unitLength));
}

glm::dvec3 toSpace(ColorSpace space, const glm::dvec3& rgb) {
  switch (space) {
  case ColorSpace::hsv:
    return hb::rgbToHsv(rgb);
  case ColorSpace::lab:
    return hb::xyzToLab(hb::linearToXyz(hb::srgbToLinear(rgb)));
  case ColorSpace::diverging:
    return hb::labToMsh(toSpace(ColorSpace::lab, rgb));
  case ColorSpace::rgb:
  case ColorSpace::step:
    break;
  }
  return rgb;
}

/// Coded sRGB inside its cube.
glm::dvec3 fitted(const glm::dvec3& rgb) {
  const double most = std::max({rgb.x, rgb.y, rgb.z, 1.0});
  return glm::max(rgb / most, glm::dvec3(0.0));
}

glm::dvec3 labToRgb(const glm::dvec3& lab) { return fitted(hb::linearToSrgb(hb::xyzToLinear(hb::labToXyz(lab)))); }

glm::dvec3 mixHsv(glm::dvec3 a, glm::dvec3 b, double t, bool wrap) {
  if (wrap && std::abs(a.x - b.x) > 0.5) (a.x > b.x ? a.x : b.x) -= 1.0;
  glm::dvec3 hsv = glm::mix(a, b, t);
  if (hsv.x < 0.0) hsv.x += 1.0;
  return hb::hsvToRgb(hsv);
}

/// Coded sRGB at the fraction t of the way between two colours of the space.
glm::dvec3 mixed(const Definition& d, const glm::dvec3& a, const glm::dvec3& b, double t) {
  switch (d.colorSpace) {
  case ColorSpace::hsv:
    return mixHsv(a, b, t, d.hsvWrap);
  case ColorSpace::lab:
    return labToRgb(glm::mix(a, b, t));
  case ColorSpace::diverging:
    return labToRgb(hb::mshToLab(hb::mixMsh(a, b, t)));
  case ColorSpace::step:
    return b;
  case ColorSpace::rgb:
    break;
  }
  return glm::mix(a, b, t);
}

} // namespace

hbTransferFunction::hbTransferFunction(Definition definition, const std::string& what)
    : definition_(std::move(definition)) {
  check(definition_, what);
  const auto& colors = definition_.colors;
  auto& opacities = definition_.opacities;
  if (opacities.empty()) opacities = {{.value = colors.front().value}, {.value = colors.back().value, .opacity = 1.0}};
  const auto [lo, hi] = range();
  if (hi - lo < kLeastWidth)
    throw hbError(fmt::format("{}: expected points over a range of values, found {} to {}", what, lo, hi));
  inSpace_.reserve(colors.size());
  for (const ColorPoint& point : colors) inSpace_.push_back(toSpace(definition_.colorSpace, point.rgb));
}

std::pair<double, double> hbTransferFunction::range() const {
  const auto& colors = definition_.colors;
  const auto& opacities = definition_.opacities;
  return {std::min(colors.front().value, opacities.front().value),
          std::max(colors.back().value, opacities.back().value)};
}

glm::dvec3 hbTransferFunction::colour(double value) const {
  const Definition& d = definition_;
  if (std::isnan(value)) return hb::srgbToLinear(d.nanColor);
  if (value < d.colors.front().value) return hb::srgbToLinear(d.belowColor.value_or(d.colors.front().rgb));
  if (value > d.colors.back().value) return hb::srgbToLinear(d.aboveColor.value_or(d.colors.back().rgb));
  const auto above = std::lower_bound(d.colors.begin(), d.colors.end(), value,
                                      [](const ColorPoint& point, double x) { return point.value < x; });
  if (above->value == value) return hb::srgbToLinear(above->rgb);
  const auto below = above - 1;
  const double t = (value - below->value) / (above->value - below->value);
  const std::size_t i = std::size_t(above - d.colors.begin());
  return hb::srgbToLinear(mixed(d, inSpace_[i - 1], inSpace_[i], t));
}

double hbTransferFunction::opacity(double value) const {
  if (std::isnan(value)) return definition_.nanOpacity;
  const auto& points = definition_.opacities;
  const bool inside = value >= points.front().value && value <= points.back().value;
  if (!inside && definition_.outside == Outside::zero) return 0.0;
  const auto above = std::upper_bound(points.begin(), points.end(), value,
                                      [](double x, const OpacityPoint& point) { return x < point.value; });
  if (above == points.begin()) return above->opacity;
  return above == points.end() ? points.back().opacity : opacityBetween(above[-1], *above, value);
}

// vtkPiecewiseFunction::GetTable(). Its Hermite curve with the slope (1 - sharpness) at both ends is the same as a
// mixture of the straight line and the curve 3 t^2 - 2 t^3.
double hbTransferFunction::opacityBetween(const OpacityPoint& first, const OpacityPoint& second, double value) {
  if (value <= first.value) return first.opacity;
  if (value >= second.value) return second.opacity;
  constexpr double kLeast = 1e-5, kStraight = 0.01;
  const double middle = std::clamp(first.midpoint, kLeast, 1.0 - kLeast);
  const double place = (value - first.value) / (second.value - first.value);
  double t = place < middle ? 0.5 * place / middle : 0.5 + 0.5 * (place - middle) / (1.0 - middle);
  if (const double sharpness = first.sharpness; sharpness >= kStraight) {
    const double power = 1.0 + 10.0 * sharpness;
    t = t < 0.5 ? 0.5 * std::pow(2.0 * t, power) : 1.0 - 0.5 * std::pow(2.0 * (1.0 - t), power);
    t += sharpness * (t * t * (3.0 - 2.0 * t) - t);
  }
  const auto [least, most] = std::minmax(first.opacity, second.opacity);
  return std::clamp(first.opacity + t * (second.opacity - first.opacity), least, most);
}

double hbTransferFunction::opticalDepth(double value) const {
  return std::min(-std::log1p(-opacity(value)), kMaxOpticalDepth);
}

double hbTransferFunction::extinction(double value) const {
  if (!definition_.unitLength) throw hbError("transfer function: ScalarOpacityUnitDistance: expected, but missing");
  return opticalDepth(value) / *definition_.unitLength;
}

hbTransferFunction hbTransferFunction::rescaled(double lo, double hi) const {
  if (!(hi - lo >= kLeastWidth && std::abs(lo) <= kMaxValue && std::abs(hi) <= kMaxValue))
    throw hbError(
        fmt::format("transfer function: expected a range of two 32-bit floats, the first less than the second, "
                    "found {} to {}",
                    lo, hi));
  const auto [first, last] = range();
  // The ends are hit exactly, and the order is kept.
  const auto move = [&, first = first, last = last](double& value) {
    const double t = (value - first) / (last - first);
    value = t == 1.0 ? hi : std::min(lo + t * (hi - lo), hi);
  };
  Definition moved = definition_;
  for (ColorPoint& point : moved.colors) move(point.value);
  for (OpacityPoint& point : moved.opacities) move(point.value);
  moved.relative = false;
  return hbTransferFunction(std::move(moved));
}

hbTransferFunction hbTransferFunction::withUnitLength(double length) const {
  Definition changed = definition_;
  changed.unitLength = length;
  return hbTransferFunction(std::move(changed));
}

double hbTransferFunction::defaultUnitLength(const hbGeometry& geometry) {
  const glm::dvec3 extent = geometry.extent();
  return std::max({extent.x, extent.y, extent.z}) / 100.0;
}
