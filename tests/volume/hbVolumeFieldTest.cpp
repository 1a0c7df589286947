#include "volume/hbVolumeField.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace {

hbGeometry cubeOf(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  return g;
}

float valueAt(const hbField& field, const std::array<float, 3>& p, int component = 0) {
  float out = 0.0F;
  field.values({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, component, {&out, 1});
  return out;
}

} // namespace

TEST(hbVolumeField, ReturnsTheSamplesAtTheNodes) {
  // Sizes of 2^n + 1, whose node coordinates a float holds exactly: the samples come back exactly.
  const hbSize3 size{5, 3, 9};
  std::vector<std::uint16_t> samples(std::size_t(size.x * size.y * size.z));
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = std::uint16_t(i * 7919U);
  const hbVolumeField field(hbVolume::fromSamples(cubeOf(size), samples));
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i)
        EXPECT_EQ(valueAt(field, {float(i) / 4, float(j) / 2, float(k) / 8}),
                  float(samples[std::size_t(i + 5 * (j + 3 * k))]));
}

TEST(hbVolumeField, ClampsCoordinatesToTheCube) {
  const hbVolumeField field(hbVolume::fromSamples<float>(cubeOf({2, 1, 1}), {1.0F, 3.0F}));
  EXPECT_EQ(valueAt(field, {-5.0F, 0.5F, 0.5F}), 1.0F);
  EXPECT_EQ(valueAt(field, {7.0F, 0.5F, 0.5F}), 3.0F);
  EXPECT_EQ(valueAt(field, {std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F}), 1.0F);
  EXPECT_EQ(valueAt(field, {0.25F, 9.0F, -1.0F}), 1.5F);
}

TEST(hbVolumeField, SameValuesWhateverTheLayoutAndByteOrder) {
  // One 3x4x2 volume of two components, written z-fastest and big-endian, against the packed one.
  const hbSize3 size{3, 4, 2};
  std::vector<std::int16_t> packed(48);
  for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = std::int16_t(int(i * 1237U % 2001U) - 1000);
  auto shuffled = std::make_shared<std::vector<std::byte>>(packed.size() * 2);
  const hbVolume::Layout layout{{8, 2, 1}, 24, true};
  const auto put = [&](std::int64_t to, std::int16_t v) {
    (*shuffled)[std::size_t(2 * to)] = std::byte(std::uint16_t(v) >> 8U);
    (*shuffled)[std::size_t(2 * to + 1)] = std::byte(std::uint16_t(v) & 0xFFU);
  };
  for (int c = 0; c < 2; ++c)
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 3; ++i) put(8 * i + 2 * j + k + 24 * c, packed[std::size_t(c + 2 * (i + 3 * (j + 4 * k)))]);
  const hbVolumeField a(hbVolume::fromSamples(cubeOf(size), packed, 2));
  const hbVolumeField b(hbVolume(cubeOf(size), hbSampleType::int16, 2, {shuffled, shuffled->data()}, layout));
  for (int c = 0; c < 2; ++c)
    for (const std::array<float, 3> p :
         {std::array{0.1F, 0.7F, 0.3F}, std::array{0.9F, 0.2F, 0.99F}, std::array{0.5F, 1.0F, 0.0F}})
      EXPECT_EQ(valueAt(a, p, c), valueAt(b, p, c));
}

TEST(hbVolumeField, SlopeAndInterceptApply) {
  hbVolume volume = hbVolume::fromSamples<std::uint8_t>(cubeOf({2, 1, 1}), {10, 20});
  volume.setSlopeIntercept(0.5, -100.0);
  EXPECT_EQ(volume.value(1, 0, 0), -90.0);
  const hbVolumeField field(volume);
  EXPECT_EQ(field.valueMap().toTrue(valueAt(field, {0.5F, 0.0F, 0.0F})), -92.5);
}

TEST(hbVolumeField, WideIntegersKeepNeighboursApart) {
  // 2^30 and 2^30 + 1 are the same float; centred they are not.
  const std::int32_t base = 1 << 30;
  const hbVolume volume = hbVolume::fromSamples<std::int32_t>(cubeOf({2, 1, 1}), {base, base + 1});
  const hbVolumeField field(volume);
  const double a = field.valueMap().toTrue(valueAt(field, {0, 0, 0})),
               b = field.valueMap().toTrue(valueAt(field, {1, 0, 0}));
  EXPECT_EQ(a, base);
  EXPECT_EQ(b, base + 1.0);
}

TEST(hbVolumeField, DoublesBeyondTheRangeOfAFloatAreScaled) {
  const hbVolume volume = hbVolume::fromSamples<double>(cubeOf({2, 1, 1}), {1e200, -3e200});
  const hbVolumeField field(volume);
  EXPECT_DOUBLE_EQ(field.valueMap().toTrue(valueAt(field, {0, 0, 0})) / 1e200,
                   double(float(1e200 / field.valueMap().scale)) * field.valueMap().scale / 1e200);
  EXPECT_NEAR(field.valueMap().toTrue(valueAt(field, {1, 0, 0})) / -3e200, 1.0, 0x1p-24);
}

TEST(hbVolumeField, HugeValuesNeitherOverflowNorVanish) {
  for (const double largest : {3e38, 1e60, 1.7e308}) {
    const hbVolume volume = hbVolume::fromSamples<double>(cubeOf({3, 1, 1}), {-largest, 1.0, largest});
    const hbVolumeField field(volume);
    for (const float x : {0.0F, 0.25F, 0.5F, 1.0F}) {
      const double expected = (2.0 * x - 1.0) * largest, found = field.valueMap().toTrue(valueAt(field, {x, 0, 0}));
      EXPECT_NEAR(found / largest, expected / largest, 4 * 0x1p-24);
    }
  }
  const hbVolume floats = hbVolume::fromSamples<float>(cubeOf({2, 1, 1}), {-3e38F, 3e38F});
  const hbVolumeField field(floats);
  EXPECT_NEAR(field.valueMap().toTrue(valueAt(field, {0.75F, 0, 0})) / 1.5e38, 1.0, 4 * 0x1p-24);
}

TEST(hbVolumeField, SlopesThatMakeNeighboursMeetAreCentred) {
  hbVolume volume = hbVolume::fromSamples<std::uint8_t>(cubeOf({2, 1, 1}), {10, 11});
  volume.setSlopeIntercept(1e-6, 1000.0);
  const hbVolumeField field(volume);
  const double a = field.valueMap().toTrue(valueAt(field, {0, 0, 0})),
               b = field.valueMap().toTrue(valueAt(field, {1, 0, 0}));
  EXPECT_NEAR(b - a, 1e-6, 1e-12);
  EXPECT_NEAR(a, 1000.00001, 1e-12 + 1000 * 0x1p-52);
}

// The offset is a float, and every sample between half of it and twice it: differences are exact (Sterbenz).
TEST(hbVolumeField, FloatsWithALargeOffsetAreCentredExactly) {
  for (const float sign : {1.0F, -1.0F}) {
    std::vector<float> samples;
    for (int i = 0; i < 64; ++i) samples.push_back(sign * (1e6F + float(i * i % 61) / 16.0F));
    const hbVolumeField field(hbVolume::fromSamples<float>(cubeOf({64, 1, 1}), samples));
    EXPECT_NEAR(field.valueMap().offset, double(sign) * 1e6, 4.0);
    std::vector<float> values(samples.size());
    field.lattice(field.geometry().cubeCoordinates(0), std::vector{0.5}, std::vector{0.5}, 0, values.data(), 0, 0);
    for (std::size_t i = 0; i < samples.size(); ++i)
      EXPECT_EQ(field.valueMap().toTrue(double(values[i])), double(samples[i])) << i;
  }
}

// Of 257^3 samples one in 265 is looked at; the one that is not has bits below those of the offset.
TEST(hbVolumeField, FloatsThatWereNotAllLookedAtAreNotCentred) {
  const hbSize3 size{257, 257, 257};
  std::vector<float> samples(std::size_t(257) * 257 * 257, 1000.0F);
  samples.front() = 1001.0F;
  samples[1] = 0.1F;
  const hbVolumeField field(hbVolume::fromSamples<float>(cubeOf(size), std::move(samples)));
  EXPECT_TRUE(field.valueMap().isIdentity());
  EXPECT_EQ(valueAt(field, {1.0F / 256, 0.0F, 0.0F}), 0.1F);
}

TEST(hbVolumeField, FloatsAroundZeroAreNot) {
  const hbVolumeField field(hbVolume::fromSamples<float>(cubeOf({3, 1, 1}), {-1.0F, 4.0F, 6.0F}));
  EXPECT_TRUE(field.valueMap().isIdentity());
}

TEST(hbVolumeField, TheGradientIsThatOfTheInterpolant) {
  // f = 2x - 3y + 5z + 4xy is trilinear, so its interpolant and gradient are exact up to rounding:
  // values up to 11, four lerps a component: below 64 eps * 11 * cells.
  const hbSize3 size{5, 9, 3};
  std::vector<float> samples;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 5; ++i) {
        const float x = float(i) / 4, y = float(j) / 8, z = float(k) / 2;
        samples.push_back(2 * x - 3 * y + 5 * z + 4 * x * y);
      }
  const hbVolumeField field(hbVolume::fromSamples(cubeOf(size), samples));
  constexpr float kTolerance = 64.0F * 0x1p-24F * 11.0F * 8.0F;
  for (const auto& [x, y, z] :
       {std::array{0.3F, 0.6F, 0.9F}, std::array{1.0F, 1.0F, 1.0F}, std::array{0.0F, 0.5F, 0.25F}}) {
    float v, dx, dy, dz;
    field.gradients({{&x, 1}, {&y, 1}, {&z, 1}}, 0, {&v, 1}, {{&dx, 1}, {&dy, 1}, {&dz, 1}});
    EXPECT_NEAR(v, 2 * x - 3 * y + 5 * z + 4 * x * y, kTolerance);
    EXPECT_NEAR(dx, 2 + 4 * y, kTolerance);
    EXPECT_NEAR(dy, -3 + 4 * x, kTolerance);
    EXPECT_NEAR(dz, 5, kTolerance);
  }
}

RC_GTEST_PROP(hbVolumeField, TheRangeEnclosesEveryValueOfTheBox, ()) {
  const auto axis = rc::gen::inRange(1, 7);
  const hbSize3 size{*axis, *axis, *axis};
  const auto samples = *rc::gen::container<std::vector<float>>(
      std::size_t(size.x * size.y * size.z),
      rc::gen::map(rc::gen::inRange(-1000, 1000), [](int v) { return float(v) / 7.0F; }));
  const hbVolumeField field(hbVolume::fromSamples(cubeOf(size), samples));
  const auto unit = rc::gen::map(rc::gen::inRange(0, 1025), [](int v) { return float(v) / 1024.0F; });
  hbBox box;
  std::array<float, 3> p{};
  for (int d = 0; d < 3; ++d) {
    const float a = *unit, b = *unit;
    box.lo[d] = std::min(a, b);
    box.hi[d] = std::max(a, b);
    p[std::size_t(d)] = box.lo[d] + *unit * (box.hi[d] - box.lo[d]);
  }
  RC_ASSERT(field.range(box, 0).contains(valueAt(field, p)));
}

TEST(hbVolumeField, TheNearestSampleIsOneOfTheSamples) {
  const hbVolumeField field =
      hbVolumeField(hbVolume::fromSamples<std::uint8_t>(cubeOf({5, 2, 1}), {9, 7, 0, 200, 3, 1, 2, 4, 8, 16}))
          .nearest();
  EXPECT_EQ(valueAt(field, {0.0F, 0.0F, 0.3F}), 9.0F);
  EXPECT_EQ(valueAt(field, {0.124F, 0.49F, 0.0F}), 9.0F);
  EXPECT_EQ(valueAt(field, {0.125F, 0.0F, 0.0F}), 7.0F); // half-way
  EXPECT_EQ(valueAt(field, {0.87F, 0.5F, 0.0F}), 8.0F);
  EXPECT_EQ(valueAt(field, {2.0F, 9.0F, 0.0F}), 16.0F);
  EXPECT_EQ(valueAt(field, {std::numeric_limits<float>::quiet_NaN(), -1.0F, 0.0F}), 9.0F);
  std::array<float, 3> p{0.3F, 0.2F, 0.1F}, slopes{1.0F, 1.0F, 1.0F};
  float value = 0.0F;
  field.gradients({{&p[0], 1}, {&p[1], 1}, {&p[2], 1}}, 0, {&value, 1},
                  {{&slopes[0], 1}, {&slopes[1], 1}, {&slopes[2], 1}});
  EXPECT_EQ(value, 7.0F);
  EXPECT_EQ(slopes, (std::array<float, 3>{}));
  const std::array<double, 3> xs{0.1, 0.4, 0.9}, ys{0.2, 0.5, 1.0}, zs{0.0, 0.5, 1.0};
  std::array<float, 27> lattice{};
  field.lattice(xs, ys, zs, 0, lattice.data(), 3, 9);
  for (std::size_t i = 0; i < lattice.size(); ++i)
    EXPECT_EQ(lattice[i], valueAt(field, {float(xs[i % 3]), float(ys[i / 3 % 3]), float(zs[i / 9])})) << i;
}
