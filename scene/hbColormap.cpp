#include "scene/hbColormap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>

#include "scene/hbColorSpace.h"
#include "volume/hbError.h"

namespace {

glm::dvec3 gray(double t) { return glm::dvec3(t); }
glm::dvec3 inverseGray(double t) { return glm::dvec3(1.0 - t); }

glm::dvec3 heat(double t) {
  return glm::clamp(glm::dvec3(3.0 * t, 3.0 * t - 1.0, 3.0 * t - 2.0), glm::dvec3(0.0), glm::dvec3(1.0));
}

// Green 2011, section 3: a helix round the gray diagonal, in a plane of constant perceived brightness.
glm::dvec3 cubehelix(double t) {
  constexpr double kStart = 0.5, kRotations = -1.5;
  const double angle = 2.0 * std::numbers::pi * (kStart / 3.0 + kRotations * t);
  const double amplitude = t * (1.0 - t) / 2.0;
  const double c = amplitude * std::cos(angle), s = amplitude * std::sin(angle);
  const glm::dvec3 rgb{t - 0.14861 * c + 1.78277 * s, t - 0.29227 * c - 0.90649 * s, t + 1.97294 * c};
  return glm::clamp(rgb, glm::dvec3(0.0), glm::dvec3(1.0));
}

glm::dvec3 mshOfSrgb8(const glm::dvec3& rgb8) {
  return hb::labToMsh(hb::xyzToLab(hb::linearToXyz(hb::srgbToLinear(rgb8 / 255.0))));
}

glm::dvec3 coolwarm(double t) {
  static const glm::dvec3 kCool = mshOfSrgb8({59, 76, 192}), kWarm = mshOfSrgb8({180, 4, 38});
  const glm::dvec3 lab = hb::mshToLab(hb::mixMsh(kCool, kWarm, t));
  const glm::dvec3 rgb = hb::linearToSrgb(hb::xyzToLinear(hb::labToXyz(lab)));
  return glm::clamp(rgb, glm::dvec3(0.0), glm::dvec3(1.0));
}

// Parallel to each other.
constexpr std::array<std::string_view, 5> kNames{"gray", "inverse-gray", "heat", "cubehelix", "coolwarm"};
constexpr std::array kMaps{gray, inverseGray, heat, cubehelix, coolwarm};
static_assert(kNames.size() == kMaps.size());

} // namespace

hbColormap::hbColormap(std::string_view name)
    : index_(std::size_t(std::find(kNames.begin(), kNames.end(), name) - kNames.begin())) {
  if (index_ == kNames.size())
    throw hbError(fmt::format("colormap: expected one of {}, found '{}'", fmt::join(kNames, ", "), name));
}

std::string_view hbColormap::name() const { return kNames[index_]; }

std::span<const std::string_view> hbColormap::names() { return kNames; }

glm::dvec3 hbColormap::rgb(double t) const { return kMaps[index_](t > 0.0 ? std::min(t, 1.0) : 0.0); }
