#include "volume/hbMagnitudeField.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbVolumeField.h"

namespace {

/// Components f, g, h, trilinear, on 3 x 2 x 4 samples.
hbVolumeField vectorField(const std::vector<float>& samples, int components, const hbValueMap& map = {}) {
  hbGeometry geometry;
  geometry.size = {3, 2, 4};
  return {hbVolume::fromSamples(geometry, samples, components), map};
}

float valueAt(const hbField& field, const std::array<float, 3>& p, int component = 0) {
  float value;
  field.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, component, {&value, 1});
  return value;
}

} // namespace

TEST(hbMagnitudeField, IsTheLengthOfTheVector) {
  std::vector<float> samples;
  for (int i = 0; i < 24; ++i) samples.insert(samples.end(), {3.0F, -4.0F});
  const auto vector = std::make_shared<const hbVolumeField>(vectorField(samples, 2));
  const hbMagnitudeField magnitude(vector);
  EXPECT_EQ(magnitude.components(), 1);
  EXPECT_EQ(magnitude.geometry(), vector->geometry());
  EXPECT_TRUE(magnitude.valueMap().isIdentity());
  EXPECT_EQ(valueAt(magnitude, {0.3F, 0.7F, 0.1F}), 5.0F);
  EXPECT_TRUE(magnitude.range({}, 0).contains(5.0F));
  EXPECT_LT(magnitude.range({}, 0).hi, 5.001F);
  EXPECT_GT(magnitude.range({}, 0).lo, 4.999F);
}

TEST(hbMagnitudeField, IsInTrueValues) {
  // 1 + 2 v: the field's own values 1 and 1.5 stand for 3 and 4.
  std::vector<float> samples;
  for (int i = 0; i < 24; ++i) samples.insert(samples.end(), {3.0F, 4.0F});
  const hbMagnitudeField magnitude(std::make_shared<const hbVolumeField>(vectorField(samples, 2, {1.0, 2.0})));
  EXPECT_EQ(valueAt(magnitude, {0.5F, 0.5F, 0.5F}), 5.0F);
}

TEST(hbMagnitudeField, ZeroHasNoSlope) {
  const hbMagnitudeField magnitude(std::make_shared<const hbVolumeField>(vectorField(std::vector<float>(48), 2)));
  const float p = 0.4F;
  float value, dx, dy, dz;
  magnitude.gradients({{&p, 1}, {&p, 1}, {&p, 1}}, 0, {&value, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
  EXPECT_EQ(value, 0.0F);
  EXPECT_EQ(dx, 0.0F);
  EXPECT_EQ(dy, 0.0F);
  EXPECT_EQ(dz, 0.0F);
}

RC_GTEST_PROP(hbMagnitudeField, AgreesWithTheComponents, ()) {
  const auto components = *rc::gen::inRange(1, 5);
  const auto samples = *rc::gen::container<std::vector<float>>(
      std::size_t(24 * components), rc::gen::map(rc::gen::inRange(-1000, 1000), [](int v) { return float(v) / 8.0F; }));
  const auto vector = std::make_shared<const hbVolumeField>(vectorField(samples, components));
  const hbMagnitudeField magnitude(vector);
  const auto unit = rc::gen::map(rc::gen::inRange(0, 1025), [](int v) { return float(v) / 1024.0F; });
  const std::array<float, 3> p{*unit, *unit, *unit}, q{*unit, *unit, *unit};
  const hbPoints point{{&p[0], 1}, {&p[1], 1}, {&p[2], 1}};

  double sum = 0.0;
  glm::dvec3 slope(0.0);
  for (int c = 0; c < components; ++c) {
    float v, dx, dy, dz;
    vector->gradients(point, c, {&v, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
    sum += double(v) * double(v);
    slope += double(v) * glm::dvec3(dx, dy, dz);
  }
  const double length = std::sqrt(sum);
  float value, dx, dy, dz;
  magnitude.gradients(point, 0, {&value, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
  // One rounding to a float at the end; slopes are at most 3 cells times 250 times the components' number.
  RC_ASSERT(std::abs(value - length) <= length * 0x1p-23);
  RC_ASSERT(value == valueAt(magnitude, p));
  if (length > 0.0) {
    const double bound = 3.0 * 250.0 * components * 0x1p-23;
    RC_ASSERT(std::abs(dx - slope.x / length) <= bound);
    RC_ASSERT(std::abs(dy - slope.y / length) <= bound);
    RC_ASSERT(std::abs(dz - slope.z / length) <= bound);
  }
  hbBox box;
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = std::min(p[std::size_t(d)], q[std::size_t(d)]);
    box.hi[d] = std::max(p[std::size_t(d)], q[std::size_t(d)]);
  }
  RC_ASSERT(magnitude.range(box, 0).contains(value));
  RC_ASSERT(magnitude.range(box, 0).contains(valueAt(magnitude, q)));
}
