#include "volume/fields/hbAnalyticField.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbError.h"

namespace {

// Every field and every state of the orbital.
const std::array<std::string, 9> kAll{
    "hydrogen", "hydrogen,state=2p", "hydrogen,state=4f", "marschner-lobb", "vortex", "ball,radius=0.3", "kink",
    "smooth",   "multilinear"};

rc::Gen<double> unit() {
  return rc::gen::map(rc::gen::inRange(0, 1 << 20), [](int i) { return double(i) / (1 << 20); });
}

} // namespace

TEST(hbAnalyticField, KnownValues) {
  const auto at = [](const char* name, double x, double y, double z) {
    return hbAnalyticField::create(name)->value({x, y, z});
  };
  // 3d_z2 at X = Y = 0, Z = 6 (z = 0.625): (2 * 36 * exp(-2))^2.
  EXPECT_NEAR(at("hydrogen", 0.5, 0.5, 0.625), std::pow(72.0 * std::exp(-2.0), 2), 1e-12);
  EXPECT_NEAR(at("hydrogen,state=2p,half-width=4", 0.5, 0.5, 0.75), std::pow(2.0 * std::exp(-1.0), 2), 1e-12);
  EXPECT_NEAR(at("hydrogen,state=4f,half-width=8", 0.5, 0.5, 0.75), std::pow(4.0 * 2.0 * 16.0 * std::exp(-1.0), 2),
              1e-9);
  // In the middle: (1 - 0 + 0.25 (1 + cos(12 pi))) / 2.5 = 1.5 / 2.5.
  EXPECT_NEAR(at("marschner-lobb", 0.5, 0.5, 0.5), 0.6, 1e-12);
  EXPECT_EQ(at("ball", 0.503, 0.497, 0.5), 1.0);
  EXPECT_EQ(at("ball", 0.503 + 0.36, 0.497, 0.5), 0.0);
  EXPECT_NEAR(at("kink", 0.1, 0.2, 0.3), 0.9, 1e-15);
  EXPECT_NEAR(at("multilinear", 1, 1, 1), 16.0, 1e-15);
  // x = y = 1/2, z = 1: s = 1, s2 = -2 pi^2, g = 0, g2 = -4 + 8 (2 - 3) + 0 = -12, so the value is 12.
  EXPECT_NEAR(at("vortex", 0.5, 0.5, 1.0), 12.0, 1e-12);
}

RC_GTEST_PROP(hbAnalyticField, GradientsMatchCentralDifferences, ()) {
  // Central differences with h = 1e-4 err by h^2/6 |f'''|, the largest third derivative being that of marschner-lobb:
  // about alpha/(2(1+alpha)) (2 pi f pi/2 * 2)^3 = 0.1 * 118^3, hence 3e-4, and by eps/h of the values (below 1e5:
  // 1e-7).
  for (const char* name : {"hydrogen", "hydrogen,state=2p", "marschner-lobb", "smooth", "multilinear"}) {
    const auto field = hbAnalyticField::create(name);
    const glm::dvec3 p{0.05 + 0.9 * *unit(), 0.05 + 0.9 * *unit(), 0.05 + 0.9 * *unit()};
    const hbDual f = field->valueAndGradient(p);
    RC_ASSERT(f.value == field->value(p));
    constexpr double kH = 1e-4;
    for (int d = 0; d < 3; ++d) {
      glm::dvec3 step(0.0);
      step[d] = kH;
      const double difference = (field->value(p + step) - field->value(p - step)) / (2.0 * kH);
      // The orbitals' cusps at the nucleus are their own third derivative: stay 0.02 away, where it is below 24^3 * 100
      // / 0.02.
      if (std::string(name).starts_with("hydrogen") && glm::length(p - glm::dvec3(0.5)) < 0.02) continue;
      RC_ASSERT(std::abs(difference - f.gradient[d]) <=
                1e-3 * (1.0 + std::abs(f.gradient[d])) + (name[0] == 'h' ? 0.12 : 0.0));
    }
  }
}

RC_GTEST_PROP(hbAnalyticField, RangesEncloseEveryValueOfTheBox, ()) {
  const std::string name = *rc::gen::elementOf(kAll);
  const auto field = hbAnalyticField::create(name);
  hbBox box;
  std::array<float, 3> p{};
  for (int d = 0; d < 3; ++d) {
    const auto [lo, hi] = std::minmax({float(*unit()), float(*unit())});
    box.lo[d] = lo;
    box.hi[d] = hi;
    p[std::size_t(d)] = std::clamp(lo + float(*unit()) * (hi - lo), lo, hi);
  }
  float value = 0.0F;
  field->values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1});
  const hbRange range = field->range(box, 0);
  RC_ASSERT(range.contains(value));
}

TEST(hbAnalyticField, TheSpecificationNamesEveryParameterAndGivesTheSameField) {
  for (const std::string& name : kAll) {
    const auto field = hbAnalyticField::create(name);
    const auto again = hbAnalyticField::create(field->specification());
    EXPECT_EQ(again->specification(), field->specification());
    EXPECT_EQ(again->value({0.3, 0.6, 0.2}), field->value({0.3, 0.6, 0.2}));
  }
}

TEST(hbAnalyticField, SizesAreNominal) {
  const auto field = hbAnalyticField::create("smooth,size=5x9x1");
  EXPECT_EQ(field->geometry().size, hbSize3(5, 9, 1));
  EXPECT_EQ(field->geometry().extent().x, 1.0);
  // A flat axis shows the middle.
  float x = 0.2F, y = 0.4F, z = 0.9F, out = 0.0F;
  field->values({{&x, 1}, {&y, 1}, {&z, 1}}, 0, {&out, 1});
  EXPECT_EQ(out, float(field->value({double(x), double(y), 0.5})));
  EXPECT_EQ(field->withSize({7, 7, 7})->geometry().size, hbSize3(7, 7, 7));
}

TEST(hbAnalyticField, AnotherSizeIsTheSameFormula) {
  for (const std::string& name : kAll) {
    const auto field = hbAnalyticField::create(name), resized = field->withSize({3, 5, 9});
    EXPECT_EQ(resized->geometry().size, hbSize3(3, 5, 9));
    EXPECT_EQ(resized->value({0.3, 0.6, 0.2}), field->value({0.3, 0.6, 0.2})) << name;
    EXPECT_EQ(hbAnalyticField::create(resized->specification())->geometry(), resized->geometry());
  }
  EXPECT_EQ(hbAnalyticField::create("kink")->withSize(hbSize3((1 << 20) + 1))->geometry().size.x, (1 << 20) + 1);
}

TEST(hbAnalyticField, RefusesWhatItDoesNotKnow) {
  for (const char* bad :
       {"", "nothing", "hydrogen,state=9z", "hydrogen,spin=1", "ball,radius=x", "ball,radius=", "ball,radius",
        "ball,radius=1e99", "smooth,size=0", "smooth,size=2x2", "smooth,size=2x2x2x2", "smooth,size=9999999999999"})
    EXPECT_THROW(hbAnalyticField::create(bad), hbError) << bad;
}
