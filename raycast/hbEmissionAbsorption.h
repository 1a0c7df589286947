#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "scene/hbShading.h"

/// What is seen along a ray through matter that emits and absorbs light, front to back.
///
/// The matter of a step is taken as constant: it lets through exp(-extinction length) of what is behind it, and shows
/// its own colour by the rest. Source: N. Max, "Optical Models for Direct Volume Rendering", IEEE Trans. Visualization
/// and Computer Graphics 1(2), 1995, section 4, with a source term of colour times extinction.
class hbEmissionAbsorption {
public:
  /// Below this transmittance a ray may end: what is behind shows with less than a thousandth of its light.
  static constexpr double kOpaque = 0x1p-10;

  /// exp(-depth), depth >= 0, within an ulp or two: of thin pieces, which most are, by a polynomial.
  static double transmission(double depth) {
    if (depth > kThin) return std::exp(-depth);
    const double x = depth, x2 = x * x; // what is left out is below x^8 / 8!, 3e-17
    return (1.0 - x) + x2 * (0.5 - x * (1.0 / 6.0)) +
           x2 * x2 * ((1.0 / 24.0 - x * (1.0 / 120.0)) + x2 * (1.0 / 720.0 - x * (1.0 / 5040.0)));
  }
  static constexpr double kThin = 1.0 / 32.0;

  /// `matter`: red, green and blue in linear light, and the extinction in 1 / world length; `length`: in the world.
  void add(const glm::vec4& matter, double length, const hbShading::Reflection& reflection = {}) {
    if (matter.a == 0.0F) return;
    const double through = transmission(double(matter.a) * length);
    colour_ += transmittance_ * (1.0 - through) * (glm::dvec3(matter) * reflection.matter + reflection.gloss);
    transmittance_ *= through;
  }

  /// A slab that shows `slab` (red, green and blue in linear light, multiplied by the opacity, and the opacity) where
  /// it is as thick as it was integrated for, `thicknesses` times as thick.
  void addSlab(const glm::vec4& slab, double thicknesses, const hbShading::Reflection& reflection = {}) {
    if (!(slab.a > 0.0F && thicknesses > 0.0)) return;
    const double through = std::pow(1.0 - double(slab.a), thicknesses);
    const glm::dvec3 colour = glm::dvec3(slab) / double(slab.a);
    colour_ += transmittance_ * (1.0 - through) * (colour * reflection.matter + reflection.gloss);
    transmittance_ *= through;
  }

  /// What lies behind all that was added so far.
  void add(const hbEmissionAbsorption& behind) {
    colour_ += transmittance_ * behind.colour_;
    transmittance_ *= behind.transmittance_;
  }

  /// The constant matter that shows the same over this length in the world, which is positive: added to nothing, it
  /// gives this again, but for the rounding of its numbers to floats.
  glm::vec4 matter(double length) const {
    if (!(opacity() > 0.0)) return glm::vec4(0.0F);
    const double least = std::max(transmittance_, std::numeric_limits<double>::min());
    return glm::vec4(glm::dvec4(colour_ / opacity(), -std::log(least) / length));
  }

  /// In linear light, multiplied by the opacity.
  const glm::dvec3& colour() const { return colour_; }
  double transmittance() const { return transmittance_; }
  double opacity() const { return 1.0 - transmittance_; }
  /// colour() and opacity(), as pictures have them.
  glm::vec4 shown() const { return glm::vec4(glm::dvec4(colour_, opacity())); }
  bool isOpaque() const { return transmittance_ < kOpaque; }

private:
  glm::dvec3 colour_{0.0};
  double transmittance_ = 1.0;
};
