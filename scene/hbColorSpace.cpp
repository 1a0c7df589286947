#include "scene/hbColorSpace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace {

// IEC 61966-2-1, equation 7; the columns are what red, green and blue add to (X, Y, Z).
const glm::dmat3 kToXyz{{0.4124, 0.2126, 0.0193}, {0.3576, 0.7152, 0.1192}, {0.1805, 0.0722, 0.9505}};
const glm::dmat3 kFromXyz = glm::inverse(kToXyz);
const glm::dvec3 kWhite = kToXyz * glm::dvec3(1.0);

// CIE 15:2004, equations 8.3 to 8.8: the cube root, and below (6/29)^3 the straight line that continues it.
constexpr double kJoin = 6.0 / 29.0;
double lightness(double t) { return t > kJoin * kJoin * kJoin ? std::cbrt(t) : t / (3.0 * kJoin * kJoin) + 4.0 / 29.0; }
double inverseLightness(double f) { return f > kJoin ? f * f * f : 3.0 * kJoin * kJoin * (f - 4.0 / 29.0); }

constexpr double kPi = std::numbers::pi;

/// Colours of less angle from the gray axis have no hue to speak of.
constexpr double kUnsaturated = 0.05;

/// The hue an unsaturated end of magnitude `m` gets, so that the way to the saturated one looks straight.
double adjustedHue(const glm::dvec3& saturated, double m) {
  if (saturated.x >= m - 0.1) return saturated.z;
  const double spin =
      saturated.y * std::sqrt(m * m - saturated.x * saturated.x) / (saturated.x * std::sin(saturated.y));
  return saturated.z > -0.3 * kPi ? saturated.z + spin : saturated.z - spin;
}

} // namespace

double hb::srgbToLinear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

double hb::linearToSrgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

glm::dvec3 hb::srgbToLinear(const glm::dvec3& coded) {
  return {srgbToLinear(coded.x), srgbToLinear(coded.y), srgbToLinear(coded.z)};
}

glm::dvec3 hb::linearToSrgb(const glm::dvec3& linear) {
  return {linearToSrgb(linear.x), linearToSrgb(linear.y), linearToSrgb(linear.z)};
}

glm::dvec3 hb::linearToXyz(const glm::dvec3& linear) { return kToXyz * linear; }
glm::dvec3 hb::xyzToLinear(const glm::dvec3& xyz) { return kFromXyz * xyz; }

glm::dvec3 hb::xyzToLuv(const glm::dvec3& xyz) {
  const double L = 116.0 * lightness(xyz.y / kWhite.y) - 16.0;
  const double sum = xyz.x + 15.0 * xyz.y + 3.0 * xyz.z;
  if (!(sum > 0.0)) return {L, 0.0, 0.0};
  const double whiteSum = kWhite.x + 15.0 * kWhite.y + 3.0 * kWhite.z;
  return {L, 13.0 * L * (4.0 * xyz.x / sum - 4.0 * kWhite.x / whiteSum),
          13.0 * L * (9.0 * xyz.y / sum - 9.0 * kWhite.y / whiteSum)};
}

glm::dvec3 hb::xyzToLab(const glm::dvec3& xyz) {
  const double fx = lightness(xyz.x / kWhite.x), fy = lightness(xyz.y / kWhite.y), fz = lightness(xyz.z / kWhite.z);
  return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
}

glm::dvec3 hb::labToXyz(const glm::dvec3& lab) {
  const double fy = (lab.x + 16.0) / 116.0;
  return kWhite *
         glm::dvec3(inverseLightness(fy + lab.y / 500.0), inverseLightness(fy), inverseLightness(fy - lab.z / 200.0));
}

glm::dvec3 hb::rgbToHsv(const glm::dvec3& rgb) {
  const double value = std::max({rgb.x, rgb.y, rgb.z}), chroma = value - std::min({rgb.x, rgb.y, rgb.z});
  if (!(chroma > 0.0)) return {0.0, 0.0, value};
  const double sixth = rgb.x == value   ? (rgb.y - rgb.z) / chroma
                       : rgb.y == value ? 2.0 + (rgb.z - rgb.x) / chroma
                                        : 4.0 + (rgb.x - rgb.y) / chroma;
  return {(sixth < 0.0 ? sixth + 6.0 : sixth) / 6.0, chroma / value, value};
}

glm::dvec3 hb::hsvToRgb(const glm::dvec3& hsv) {
  const double sixth = 6.0 * hsv.x;
  const glm::dvec3 pure =
      glm::clamp(glm::dvec3(std::abs(sixth - 3.0) - 1.0, 2.0 - std::abs(sixth - 2.0), 2.0 - std::abs(sixth - 4.0)),
                 glm::dvec3(0.0), glm::dvec3(1.0));
  return hsv.z * (1.0 + hsv.y * (pure - 1.0));
}

glm::dvec3 hb::labToMsh(const glm::dvec3& lab) {
  const double m = glm::length(lab);
  const double s = m > 0.001 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0.0;
  return {m, s, s > 0.001 ? std::atan2(lab.z, lab.y) : 0.0};
}

glm::dvec3 hb::mshToLab(const glm::dvec3& msh) {
  return msh.x * glm::dvec3(std::cos(msh.y), std::sin(msh.y) * std::cos(msh.z), std::sin(msh.y) * std::sin(msh.z));
}

glm::dvec3 hb::mixMsh(glm::dvec3 a, glm::dvec3 b, double t) {
  const auto turn = [](double from, double to) { return std::remainder(to - from, 2.0 * kPi); };
  if (a.y > kUnsaturated && b.y > kUnsaturated && std::abs(turn(a.z, b.z)) > 0.33 * kPi) {
    const glm::dvec3 white{std::max({a.x, b.x, 88.0}), 0.0, 0.0};
    (t < 0.5 ? b : a) = white;
    t = t < 0.5 ? 2.0 * t : 2.0 * t - 1.0;
  }
  if (a.y < kUnsaturated && b.y > kUnsaturated)
    a.z = adjustedHue(b, a.x);
  else if (b.y < kUnsaturated && a.y > kUnsaturated)
    b.z = adjustedHue(a, b.x);
  return {(1.0 - t) * a.x + t * b.x, (1.0 - t) * a.y + t * b.y, a.z + t * turn(a.z, b.z)};
}
