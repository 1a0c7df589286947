#include "scene/hbTransferFunction.h"

#include <cmath>
#include <limits>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "scene/hbColorSpace.h"
#include "scene/hbColormap.h"
#include "volume/hbError.h"

namespace {

using ColorSpace = hbTransferFunction::ColorSpace;
using Definition = hbTransferFunction::Definition;
using OpacityPoint = hbTransferFunction::OpacityPoint;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEps = 0x1p-53;

hbTransferFunction between(ColorSpace space, const glm::dvec3& a, const glm::dvec3& b, bool wrap = false) {
  return hbTransferFunction({.colorSpace = space, .hsvWrap = wrap, .colors = {{0.0, a}, {1.0, b}}});
}

glm::dvec3 coded(const hbTransferFunction& function, double value) { return hb::linearToSrgb(function.colour(value)); }

void expectNear(const glm::dvec3& found, const glm::dvec3& expected, double tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << what << ", channel " << c;
}

std::string errorOf(Definition definition) {
  try {
    const hbTransferFunction function(std::move(definition));
  } catch (const hbError& e) {
    return e.what();
  }
  return "";
}

// vtkPiecewiseFunction::GetTable() (VTK 9), with the Hermite basis it uses.
double vtkOpacity(const OpacityPoint& p, const OpacityPoint& q, double value) {
  double s = (value - p.value) / (q.value - p.value);
  const double middle = std::min(std::max(p.midpoint, 1e-5), 1 - 1e-5);
  s = s < middle ? 0.5 * s / middle : 0.5 + 0.5 * (s - middle) / (1.0 - middle);
  if (p.sharpness < 0.01) return (1 - s) * p.opacity + s * q.opacity;
  if (s < 0.5) s = 0.5 * std::pow(s * 2, 1.0 + 10 * p.sharpness);
  if (s > 0.5) s = 1.0 - 0.5 * std::pow((1.0 - s) * 2, 1 + 10 * p.sharpness);
  const double h1 = 2 * s * s * s - 3 * s * s + 1, h2 = -2 * s * s * s + 3 * s * s;
  const double h3 = s * s * s - 2 * s * s + s, h4 = s * s * s - s * s;
  const double slope = (1.0 - p.sharpness) * (q.opacity - p.opacity);
  const double y = h1 * p.opacity + h2 * q.opacity + h3 * slope + h4 * slope;
  return std::min(std::max(y, std::min(p.opacity, q.opacity)), std::max(p.opacity, q.opacity));
}

} // namespace

TEST(hbTransferFunction, RgbIsMixedInCodedValues) {
  const auto f = between(ColorSpace::rgb, {0.2, 0.4, 0.0}, {0.6, 0.0, 1.0});
  // Two roundings of the mixture and those of two powers (their exponents amplify by 2.4 at most), far below 64 eps.
  expectNear(f.colour(0.25), hb::srgbToLinear(glm::dvec3(0.3, 0.3, 0.25)), 64 * kEps, "a quarter");
  expectNear(f.colour(0.0), hb::srgbToLinear(glm::dvec3(0.2, 0.4, 0.0)), 0.0, "the first");
  expectNear(f.colour(1.0), hb::srgbToLinear(glm::dvec3(0.6, 0.0, 1.0)), 0.0, "the last");
}

TEST(hbTransferFunction, HsvGoesEitherWayRound) {
  // From red over yellow, green, cyan and blue to magenta, or directly. Six times a hue has a few roundings of 6.
  const glm::dvec3 red(1, 0, 0), magenta(1, 0, 1);
  expectNear(coded(between(ColorSpace::hsv, red, magenta), 0.4), {0, 1, 0}, 1e-14, "straight");
  // linearToSrgb() misses srgbToLinear()'s inverse by 1e-14 at most where no value is near the join.
  expectNear(coded(between(ColorSpace::hsv, red, magenta, true), 0.5), {1, 0, 0.5}, 1e-14, "wrapped");
  expectNear(coded(between(ColorSpace::hsv, magenta, red, true), 0.25), {1, 0, 0.75}, 1e-14, "wrapped, reversed");
}

TEST(hbTransferFunction, LabIsMixedInLab) {
  const glm::dvec3 a(0.8, 0.3, 0.2), b(0.3, 0.5, 0.7);
  const auto lab = [](const glm::dvec3& rgb) { return hb::xyzToLab(hb::linearToXyz(hb::srgbToLinear(rgb))); };
  const auto f = between(ColorSpace::lab, a, b);
  for (int i = 0; i <= 10; ++i) {
    const double t = i / 10.0;
    // All of it in numbers up to 100, whose roundings 100 eps are a fraction of a channel again.
    const glm::dvec3 found = hb::xyzToLab(hb::linearToXyz(f.colour(t)));
    expectNear(found, (1.0 - t) * lab(a) + t * lab(b), 100 * 64 * kEps, "t " + std::to_string(t));
  }
}

TEST(hbTransferFunction, LabHasTheColoursThatParaViewShows) {
  // Half way by VTK's formulas (vtkMath::RGBToLab and back), computed apart; the second leaves the cube and is cut off.
  // VTK's constants have four digits: 7.787, 0.008856, and the matrix back; the last moves a linear channel by up to
  // 1e-4, a coded one by 12.92 times that at most.
  expectNear(coded(between(ColorSpace::lab, {0, 0, 0.5}, {1, 1, 0}), 0.5), {0.636677, 0.482540, 0.417502}, 1.3e-3, "a");
  expectNear(coded(between(ColorSpace::lab, {1, 0, 0}, {0, 0, 1}), 0.5), {0.790313, 0.0, 0.535188}, 1.3e-3, "b");
}

TEST(hbTransferFunction, DivergingIsCoolwarm) {
  const hbColormap map("coolwarm");
  const auto f = between(ColorSpace::diverging, map.rgb(0), map.rgb(1));
  for (int i = 0; i <= 100; ++i) expectNear(coded(f, i / 100.0), map.rgb(i / 100.0), 1e-12, std::to_string(i));
}

TEST(hbTransferFunction, StepHasTheUpperColour) {
  const hbTransferFunction f(
      {.colorSpace = ColorSpace::step, .colors = {{0, {1, 0, 0}}, {1, {0, 1, 0}}, {2, {0, 0, 1}}}});
  EXPECT_EQ(f.colour(0.0), glm::dvec3(1, 0, 0));
  EXPECT_EQ(f.colour(0.001), glm::dvec3(0, 1, 0));
  EXPECT_EQ(f.colour(1.0), glm::dvec3(0, 1, 0));
  EXPECT_EQ(f.colour(1.001), glm::dvec3(0, 0, 1));
}

TEST(hbTransferFunction, ColoursStayInTheirCube) {
  for (const ColorSpace space : {ColorSpace::rgb, ColorSpace::hsv, ColorSpace::lab, ColorSpace::diverging}) {
    for (int pair = 0; pair < 64; ++pair) {
      const auto corner = [](int bits) { return glm::dvec3(bits & 1, bits >> 1 & 1, bits >> 2); };
      const auto f = between(space, corner(pair & 7), corner(pair >> 3));
      for (int i = 0; i <= 16; ++i) {
        const glm::dvec3 c = f.colour(i / 16.0);
        for (int d = 0; d < 3; ++d) EXPECT_TRUE(c[d] >= 0.0 && c[d] <= 1.0 + 4 * kEps) << int(space) << " " << pair;
      }
    }
  }
}

TEST(hbTransferFunction, ValuesOutsideTheRangeAndNaN) {
  Definition d{.colors = {{-1.0, {0, 0.5, 1}}, {2.0, {1, 0.5, 0}}}, .opacities = {{-1.0, 0.25}, {2.0, 0.75}}};
  const hbTransferFunction clamped(d);
  for (const double below : {-1.0, -1.5, -kInfinity}) {
    EXPECT_EQ(clamped.colour(below), hb::srgbToLinear(glm::dvec3(0, 0.5, 1)));
    EXPECT_EQ(clamped.opacity(below), 0.25);
  }
  for (const double above : {2.0, 2.5, kInfinity}) {
    EXPECT_EQ(clamped.colour(above), hb::srgbToLinear(glm::dvec3(1, 0.5, 0)));
    EXPECT_EQ(clamped.opacity(above), 0.75);
  }
  EXPECT_EQ(clamped.colour(kNaN), hb::srgbToLinear(glm::dvec3(0.5, 0, 0)));
  EXPECT_EQ(clamped.opacity(kNaN), 0.0);

  d.belowColor = glm::dvec3(0.25);
  d.aboveColor = glm::dvec3(0.75);
  d.nanColor = {1, 1, 0};
  d.nanOpacity = 0.125;
  d.outside = hbTransferFunction::Outside::zero;
  const hbTransferFunction other(d);
  EXPECT_EQ(other.colour(-1.0), clamped.colour(-1.0));
  EXPECT_EQ(other.colour(-1.5), hb::srgbToLinear(glm::dvec3(0.25)));
  EXPECT_EQ(other.colour(kInfinity), hb::srgbToLinear(glm::dvec3(0.75)));
  EXPECT_EQ(other.colour(kNaN), glm::dvec3(1, 1, 0));
  EXPECT_EQ(other.opacity(-1.0), 0.25);
  EXPECT_EQ(other.opacity(2.0), 0.75);
  EXPECT_EQ(other.opacity(std::nextafter(-1.0, -2.0)), 0.0);
  EXPECT_EQ(other.opacity(kInfinity), 0.0);
  EXPECT_EQ(other.opacity(kNaN), 0.125);
}

TEST(hbTransferFunction, StepsHaveTwoSides) {
  const hbTransferFunction f(
      {.colors = {{0, glm::dvec3(0)}, {1, glm::dvec3(0.25)}, {1, glm::dvec3(1)}, {2, glm::dvec3(1)}},
       .opacities = {{0, 0.0}, {1, 0.5}, {1, 0.9}, {1, 1.0}, {2, 1.0}}});
  EXPECT_EQ(f.colour(1.0), hb::srgbToLinear(glm::dvec3(0.25)));
  EXPECT_EQ(f.colour(std::nextafter(1.0, 2.0)), glm::dvec3(1));
  EXPECT_EQ(f.opacity(1.0), 1.0);
  EXPECT_NEAR(f.opacity(std::nextafter(1.0, 0.0)), 0.5, kEps);
}

TEST(hbTransferFunction, WithoutOpacitiesItIsARamp) {
  const hbTransferFunction f({.colors = {{10, glm::dvec3(0)}, {20, glm::dvec3(1)}}});
  EXPECT_EQ(f.opacity(10), 0.0);
  EXPECT_EQ(f.opacity(12.5), 0.25);
  EXPECT_EQ(f.opacity(20), 1.0);
}

RC_GTEST_PROP(hbTransferFunction, PiecesAreVtksAndMonotone, ()) {
  const auto fraction = [] { return *rc::gen::inRange(0, 1001) / 1000.0; };
  const double lo = *rc::gen::inRange(-5000, 5000), width = *rc::gen::inRange(1, 5000);
  const OpacityPoint p{lo, fraction(), fraction(), fraction()}, q{lo + width, fraction(), fraction(), fraction()};
  double before = p.opacity;
  for (int i = 0; i <= 200; ++i) {
    const double value = i == 200 ? q.value : p.value + width * i / 200.0;
    const double found = hbTransferFunction::opacityBetween(p, q, value);
    // The midpoint's branches, powers up to 11 of numbers below 1, and the polynomials: some 40 roundings, of which
    // the power amplifies those before it by 11, and a midpoint of 1e-5 those of the place by 1e5 / 2.
    RC_ASSERT(std::abs(found - vtkOpacity(p, q, value)) <=
              40 * 11 * kEps / std::max(1e-5, std::min(p.midpoint, 1 - p.midpoint)));
    // Exact in exact arithmetic; a few roundings of numbers up to 1.
    RC_ASSERT((found - before) * (q.opacity - p.opacity) >= -8 * kEps);
    before = found;
  }
  RC_ASSERT(before == q.opacity);
}

TEST(hbTransferFunction, OpacityIsPerUnitLength) {
  const hbTransferFunction f({.colors = {{0, glm::dvec3(0)}, {1, glm::dvec3(1)}}, .unitLength = 2.5});
  for (const double a : {0.0, 0.1, 0.5, 0.999}) {
    for (const double d : {0.1, 2.5, 30.0}) {
      // exp and log1p round once each; the error of the exponent is relative, that is x eps of the result.
      const double x = -std::log1p(-a) * d / 2.5;
      EXPECT_NEAR(1.0 - std::exp(-f.extinction(a) * d), 1.0 - std::pow(1.0 - a, d / 2.5), (4 + 4 * x) * kEps);
    }
  }
  EXPECT_EQ(f.extinction(1.0), hbTransferFunction::kMaxOpticalDepth / 2.5);
  // The greatest opacity below 1 is still told from it by the rounding of one logarithm at most.
  EXPECT_NEAR(f.opticalDepth(1.0 - kEps), hbTransferFunction::kMaxOpticalDepth, 64 * kEps);
  EXPECT_EQ(f.withUnitLength(5.0).extinction(0.5), f.extinction(0.5) / 2.0);
  EXPECT_THROW(hbTransferFunction({.colors = {{0, glm::dvec3(0)}, {1, glm::dvec3(1)}}}).extinction(0.5), hbError);
}

TEST(hbTransferFunction, TheDefaultUnitLengthDoesNotDependOnSamples) {
  hbGeometry coarse;
  coarse.size = {11, 21, 1};
  coarse.spacing = {1.0, 2.0, 3.0};
  hbGeometry fine = coarse;
  fine.size = {101, 201, 1};
  fine.spacing = {0.1, 0.2, 3.0};
  EXPECT_EQ(hbTransferFunction::defaultUnitLength(coarse), 0.4);
  EXPECT_NEAR(hbTransferFunction::defaultUnitLength(fine), 0.4, 2 * kEps);
}

TEST(hbTransferFunction, RescalingMovesEverythingAlike) {
  for (const std::string_view name : hbTransferFunction::presetNames()) {
    const hbTransferFunction f = hbTransferFunction::preset(name);
    const auto [first, last] = f.range();
    const hbTransferFunction moved = f.rescaled(-0.1, 1e6);
    EXPECT_EQ(moved.range(), std::pair(-0.1, 1e6));
    EXPECT_FALSE(moved.definition().relative);
    EXPECT_EQ(moved.rescaled(-0.1, 1e6), moved);
    for (int i = 0; i <= 64; ++i) {
      const double t = i / 64.0, there = (1 - t) * -0.1 + t * 1e6;
      // Places differ by a few roundings of the two ranges; opacities are no steeper than 20 a range, and neither are
      // coded colours, the decoding included.
      const double place = 16 * 20 * (1 + (std::abs(first) + std::abs(last)) / (last - first)) * kEps;
      EXPECT_NEAR(moved.opacity(there), f.opacity((1 - t) * first + t * last), place) << name << " " << i;
      EXPECT_LT(glm::distance(moved.colour(there), f.colour((1 - t) * first + t * last)), 1000 * place) << name;
    }
  }
  const hbTransferFunction f = hbTransferFunction::preset("fire");
  EXPECT_EQ(f.rescaled(-5.6, -0.9).range(), std::pair(-5.6, -0.9)); // -5.6 + (-0.9 - -5.6) is less than -0.9
  for (const auto& [lo, hi] :
       {std::pair(1.0, 1.0), std::pair(2.0, 1.0), std::pair(0.0, kNaN), std::pair(-kInfinity, 0.0)})
    EXPECT_THROW(f.rescaled(lo, hi), hbError);
}

TEST(hbTransferFunction, ExtremeRangesWork) {
  const hbTransferFunction f = hbTransferFunction::preset("fire");
  const double most = std::numeric_limits<float>::max(), least = std::numeric_limits<float>::denorm_min();
  for (const auto& [lo, hi] :
       {std::pair(-most, most), std::pair(0.0, least), std::pair(1.0, double(std::nextafter(1.0F, 2.0F)))}) {
    const hbTransferFunction moved = f.rescaled(lo, hi);
    EXPECT_EQ(moved.range(), std::pair(lo, hi));
    EXPECT_EQ(moved.opacity(lo), 0.0);
    EXPECT_EQ(moved.opacity(hi), 0.6);
  }
}

TEST(hbTransferFunction, PresetsAreSound) {
  for (const std::string_view name : hbTransferFunction::presetNames()) {
    const hbTransferFunction f = hbTransferFunction::preset(name);
    EXPECT_EQ(f.name(), name);
    if (f.definition().relative) {
      EXPECT_EQ(f.range(), std::pair(0.0, 1.0)) << name;
      EXPECT_FALSE(f.definition().unitLength) << name;
    } else {
      EXPECT_TRUE(name.starts_with("ct-")) << name;
      EXPECT_EQ(f.definition().unitLength, 1.0) << name;
      EXPECT_EQ(f.opacity(-1000), 0.0) << name; // air
    }
  }
  EXPECT_EQ(hbTransferFunction::preset("simulation").opacity(0.5), 0.0);
  try {
    hbTransferFunction::preset("ct");
    FAIL();
  } catch (const hbError& e) {
    EXPECT_STREQ(e.what(), "transfer function: expected one of ct-bone, ct-skin, ct-vessels, ct-lungs, mri-head, "
                           "simulation, density, fire, found 'ct'");
  }
}

TEST(hbTransferFunction, ErrorsNameTheMember) {
  const std::vector<hbTransferFunction::ColorPoint> colors{{0, glm::dvec3(0)}, {1, glm::dvec3(1)}};
  EXPECT_EQ(errorOf({}), "transfer function: RGBPoints: expected at least one point, found none");
  EXPECT_EQ(errorOf({.colors = {{0, glm::dvec3(0)}}}),
            "transfer function: expected points over a range of values, found 0 to 0");
  EXPECT_EQ(errorOf({.colors = {{0, glm::dvec3(0)}, {1, {0, 0, 1.5}}}}),
            "transfer function: RGBPoints: point 2: expected channels in [0,1], found 1.5");
  EXPECT_EQ(
      errorOf({.colors = {{0, glm::dvec3(0)}, {-1, glm::dvec3(1)}}}),
      "transfer function: RGBPoints: point 2: expected a value of at least 0, that of the point before, found -1");
  EXPECT_EQ(errorOf({.colors = {{0, glm::dvec3(0)}, {1e39, glm::dvec3(1)}}}),
            "transfer function: RGBPoints: point 2: expected a value in the range of 32-bit floats, found 1e+39");
  EXPECT_EQ(errorOf({.colors = colors, .opacities = {{kNaN, 0.0}}}),
            "transfer function: Points: point 1: expected a value in the range of 32-bit floats, found nan");
  EXPECT_EQ(errorOf({.colors = colors, .opacities = {{0, -0.5}}}),
            "transfer function: Points: point 1: expected an opacity in [0,1], found -0.5");
  EXPECT_EQ(errorOf({.colors = colors, .opacities = {{0, 0.5, 2.0}}}),
            "transfer function: Points: point 1: expected a midpoint in [0,1], found 2");
  EXPECT_EQ(errorOf({.colors = colors, .opacities = {{0, 0.5, 0.5, kNaN}}}),
            "transfer function: Points: point 1: expected a sharpness in [0,1], found nan");
  EXPECT_EQ(errorOf({.colors = colors, .nanOpacity = 2}),
            "transfer function: NanOpacity: expected a number in [0,1], found 2");
  EXPECT_EQ(errorOf({.colors = colors, .unitLength = 0.0}),
            "transfer function: ScalarOpacityUnitDistance: expected a length from 1e-80 to 1e80, found 0");
  EXPECT_EQ(errorOf({.colors = std::vector<hbTransferFunction::ColorPoint>(4097)}),
            "transfer function: RGBPoints: expected at most 4096 points, found 4097");
  EXPECT_EQ(errorOf({.name = std::string(257, 'x'), .colors = colors}),
            "transfer function: Name: expected at most 256 bytes, found 257");
  EXPECT_EQ(errorOf({.colors = colors, .belowColor = glm::dvec3(-1)}),
            "transfer function: BelowRangeColor: expected channels in [0,1], found -1");
}

TEST(hbTransferFunction, LabelsHaveColoursOfTheirOwn) {
  const hbTransferFunction f = hbTransferFunction::ofLabels(-2, 1000);
  for (int label = -2; label <= 1000; ++label) {
    EXPECT_EQ(f.opacity(label) > 0.0, label != 0) << label;
    EXPECT_EQ(f.colour(label), f.colour(label + 0.49)) << label;
    EXPECT_EQ(f.colour(label), f.colour(label - 0.49)) << label;
    for (int other = label - 3; other < label; ++other)
      if (other >= -2) {
        EXPECT_GT(glm::length(f.colour(label) - f.colour(other)), 0.05) << label << " " << other;
      }
  }
  EXPECT_NO_THROW(hbTransferFunction::ofLabels(5, 5));
  EXPECT_THROW(hbTransferFunction::ofLabels(0, 5000), hbError);
  EXPECT_THROW(hbTransferFunction::ofLabels(1, 0), hbError);
}
