// Emission and absorption by the ray caster.

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/hbEmissionAbsorption.h"
#include "raycast/hbRaycaster.h"
#include "scene/hbColorSpace.h"
#include "scene/hbTransferTable.h"
#include "tests/raycast/hbDvrScenes.h"
#include "volume/hbError.h"

using namespace hbTestScenes;

namespace {

/// One colour, and these opacities.
hbTransferFunction transfer(std::vector<hbTransferFunction::OpacityPoint> opacities, double unitLength,
                            const glm::dvec3& rgb = {0.9, 0.4, 0.1}) {
  hbTransferFunction::Definition d;
  d.colors = {{opacities.front().value, rgb}, {opacities.back().value, rgb}};
  d.opacities = std::move(opacities);
  d.unitLength = unitLength;
  return hbTransferFunction(std::move(d));
}

hbVolumeField volumeOf(const hbGeometry& g, const std::function<double(const glm::dvec3&)>& f) {
  std::vector<float> samples;
  for (const double z : g.cubeCoordinates(2))
    for (const double y : g.cubeCoordinates(1))
      for (const double x : g.cubeCoordinates(0)) samples.push_back(float(f({x, y, z})));
  return hbVolumeField(hbVolume::fromSamples(g, std::move(samples)));
}

/// Along x from the side of x = 0, or against it, in the middle of the picture.
hbCamera alongX(const hbGeometry& g, bool isForward) {
  return hbCamera::framing(g, isForward ? -90.0 : 90.0, 0.0, Projection::orthographic);
}

glm::dvec3 colourAt(const hbPicture& picture, std::size_t pixel) {
  return {channel(picture, "R")[pixel], channel(picture, "G")[pixel], channel(picture, "B")[pixel]};
}

constexpr std::size_t kMiddle = 19 * 6 + 9;

/// A field that counts the points it is asked for.
class Counting final : public hbField {
public:
  explicit Counting(const hbField& field) : field_(field) {}
  const hbGeometry& geometry() const override { return field_.geometry(); }
  int components() const override { return field_.components(); }
  hbValueMap valueMap() const override { return field_.valueMap(); }
  void values(const hbPoints& points, int component, std::span<float> out) const override {
    asked += std::int64_t(out.size());
    field_.values(points, component, out);
  }
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override {
    field_.gradients(points, component, out, gradient);
  }
  hbRange range(const hbBox& box, int component) const override { return field_.range(box, component); }

  mutable std::atomic<std::int64_t> asked = 0;

private:
  const hbField& field_;
};

} // namespace

TEST(hbEmissionAbsorption, LayersShowThroughWhatIsBeforeThem) {
  hbEmissionAbsorption light;
  EXPECT_EQ(light.opacity(), 0.0);
  light.add({1.0F, 0.5F, 0.0F, 2.0F}, 0.25);
  light.add({0.0F, 0.0F, 1.0F, 0.0F}, 10.0); // lets all through
  light.add({0.0F, 0.5F, 1.0F, 1.0F}, 3.0);
  const double first = 1.0 - std::exp(-0.5), second = std::exp(-0.5) * (1.0 - std::exp(-3.0));
  EXPECT_NEAR(light.colour().r, first, 1e-15);
  EXPECT_NEAR(light.colour().g, 0.5 * (first + second), 1e-15);
  EXPECT_NEAR(light.colour().b, second, 1e-15);
  EXPECT_NEAR(light.transmittance(), std::exp(-3.5), 1e-15);
  EXPECT_FALSE(light.isOpaque());
  light.add(glm::vec4(1.0F), 10.0);
  EXPECT_TRUE(light.isOpaque());
}

TEST(hbEmissionAbsorption, ThinPiecesLetThroughWhatTheExponentialSays) {
  for (int i = 0; i <= 4000; ++i) {
    const double depth = 1e-3 * std::exp(i * 0.005 - 10.0);
    EXPECT_NEAR(hbEmissionAbsorption::transmission(depth), std::exp(-depth), 0x1p-52) << depth;
  }
  EXPECT_EQ(hbEmissionAbsorption::transmission(0.0), 1.0);
  EXPECT_EQ(hbEmissionAbsorption::transmission(1e300), 0.0);
}

// exp(-sigma d), whatever the camera, the step, the sampling and the spacing.
TEST(hbDvr, AHomogeneousMediumIsExact) {
  constexpr double kOpacity = 0.3, kUnit = 0.7;
  const double sigma = -std::log(1.0 - kOpacity) / kUnit;
  const hbTransferFunction function = transfer({{0.0, kOpacity}, {1.0, kOpacity}}, kUnit);
  const glm::dvec3 linear = hb::srgbToLinear(glm::dvec3(0.9, 0.4, 0.1));
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbVolumeField field = volumeOf(g, [](const glm::dvec3&) { return 0.5; });
    int seen = 0;
    for (const hbCamera& camera : cameras(g))
      for (const int samples : {1, 7, 200})
        for (const auto kind : {hbSampling::Kind::equidistant, hbSampling::Kind::planewise}) {
          const hbScene scene = dvrScene(function, camera, samples, kind);
          const hbPicture picture = hbRaycaster(field, scene).render();
          for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
              const std::size_t i = std::size_t(x + scene.width * y);
              const auto way = inCube(g, scene, x, y);
              const double a = channel(picture, "A")[i];
              const double expected = way ? 1.0 - std::exp(-sigma * way->length) : 0.0;
              // The table's extinction is a float, and so is what is shown; opaque rays end early.
              const double tolerance =
                  (1.0 - expected) * (sigma * (way ? way->length : 0.0) * 0x1p-23) + 0x1p-24 +
                  (expected > 1.0 - hbEmissionAbsorption::kOpaque ? hbEmissionAbsorption::kOpaque : 0.0);
              EXPECT_NEAR(a, expected, tolerance) << x << " " << y;
              for (int c = 0; c < 3; ++c) EXPECT_NEAR(colourAt(picture, i)[c], linear[c] * a, 0x1p-22) << x << " " << y;
              EXPECT_NEAR(channel(picture, "Y")[i], hb::linearToXyz(colourAt(picture, i)).y, 0x1p-22);
              seen += a > 0.0;
            }
        }
    EXPECT_GT(seen, 10000);
  }
}

// A field of x seen along x, its opacity x, too: the optical depth is the integral of -ln(1 - x), which is
// x + (1 - x) ln(1 - x).
TEST(hbDvr, ALinearRampConvergesToItsClosedForm) {
  const hbGeometry g = box({17, 5, 5}, {2.0, 1.0, 1.0});
  constexpr double kMost = 0.9, kUnit = 0.5, kLength = 2.0;
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return kMost * p.x; });
  const hbTransferFunction function = transfer({{0.0, 0.0}, {kMost, kMost}}, kUnit);
  const double depth = (kMost + (1.0 - kMost) * std::log(1.0 - kMost)) * kLength / kMost / kUnit;
  for (const bool isForward : {true, false})
    for (const int samples : {4, 16, 64, 256}) {
      const hbPicture picture = hbRaycaster(field, dvrScene(function, alongX(g, isForward), samples)).render();
      // Midpoints of steps h of the value are off by h^2 / 24 of the second derivative, at most 1 / (1 - x)^2, a step;
      // the table by h^2 / 8 with its own spacing; floats: values and extinction.
      const double h = kMost / samples, own = kMost / double(hbTransferTable::kDefaultEntries - 1);
      const double worst = 1.0 / ((1.0 - kMost) * (1.0 - kMost));
      const double inDepth = (worst * (h * h / 24.0 + own * own / 8.0) + 0x1p-20) * kLength / kUnit;
      EXPECT_NEAR(channel(picture, "A")[kMiddle], 1.0 - std::exp(-depth),
                  std::exp(-depth) * std::expm1(inDepth) + 0x1p-24)
          << samples;
    }
}

// Red before blue from one side, blue before red from the other.
TEST(hbDvr, WhatIsInFrontHidesWhatIsBehind) {
  const hbGeometry g = box({65, 3, 3}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return p.x < 0.5 ? 0.0 : 1.0; });
  hbTransferFunction::Definition d;
  d.colors = {{0.0, {1.0, 0.0, 0.0}}, {0.5, {1.0, 0.0, 0.0}}, {0.5, {0.0, 0.0, 1.0}}, {1.0, {0.0, 0.0, 1.0}}};
  d.opacities = {{0.0, 0.8}, {1.0, 0.8}};
  d.unitLength = 0.5;
  const hbTransferFunction function(std::move(d));
  for (const bool isForward : {true, false}) {
    const hbPicture picture = hbRaycaster(field, dvrScene(function, alongX(g, isForward), 256)).render();
    const glm::dvec3 colour = colourAt(picture, kMiddle);
    // Half of the way each, but for the cell in which the value crosses the middle (1/64 of the way).
    const double front = 1.0 - std::pow(0.2, 1.0), behind = 0.2 * (1.0 - 0.2);
    EXPECT_NEAR(isForward ? colour.r : colour.b, front, 0.04);
    EXPECT_NEAR(isForward ? colour.b : colour.r, behind, 0.04);
    EXPECT_NEAR(colour.r + colour.b, 1.0 - 0.2 * 0.2, 1e-5);
  }
}

// A shell of opacity thinner than a step: samples may miss it, slabs do not.
TEST(hbDvr, PreintegratedSlabsMeetWhatSamplesMiss) {
  const hbGeometry g = box({33, 33, 33}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return glm::length(p - glm::dvec3(0.5)); });
  hbTransferFunction::Definition d;
  d.colors = {{0.0, {1.0, 0.2, 0.1}}, {0.3, {1.0, 0.9, 0.1}}, {0.31, {0.1, 0.2, 1.0}}, {1.0, {0.1, 1.0, 1.0}}};
  d.opacities = {{0.0, 0.0}, {0.3, 0.0}, {0.305, 0.9}, {0.31, 0.0}, {1.0, 0.0}};
  d.unitLength = 0.01;
  const hbTransferFunction function(std::move(d));
  for (const auto kind : {hbSampling::Kind::equidistant, hbSampling::Kind::planewise}) {
    const hbCamera camera = hbCamera::framing(g, 30.0, 20.0, Projection::orthographic);
    const auto drawn = [&](int samples, bool isPreintegrated) {
      hbScene scene = dvrScene(function, camera, samples, kind);
      scene.preintegrated = isPreintegrated;
      return channel(hbRaycaster(field, scene).render(), "Y");
    };
    const std::vector<float> reference = drawn(20000, false);
    const auto rmse = [&](const std::vector<float>& ys) {
      double sum = 0.0;
      for (std::size_t i = 0; i < ys.size(); ++i) sum += std::pow(double(ys[i]) - double(reference[i]), 2.0);
      return std::sqrt(sum / double(ys.size()));
    };
    for (const int samples : {64, 128, 256})
      EXPECT_LE(rmse(drawn(samples / 4, true)), rmse(drawn(samples, false))) << samples;
    EXPECT_LT(rmse(drawn(2048, true)), 0.003);
  }
}

// A homogeneous medium stays exact, but for the table's floats.
TEST(hbDvr, PreintegratedSlabsAddUpToTheRay) {
  const hbGeometry g = awkward();
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3&) { return 0.5; });
  const double sigma = -std::log(1.0 - 0.3) / 0.7;
  for (const hbCamera& camera : cameras(g))
    for (const auto kind : {hbSampling::Kind::equidistant, hbSampling::Kind::planewise}) {
      hbScene scene = dvrScene(transfer({{0.0, 0.3}, {1.0, 0.3}}, 0.7), camera, 9, kind);
      scene.preintegrated = true;
      const hbPicture picture = hbRaycaster(field, scene).render();
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const double a = channel(picture, "A")[std::size_t(x + scene.width * y)];
          const auto way = inCube(g, scene, x, y);
          // A slab's opacity is a float between its entries, off by 2^-23 of what it lets through, which is more than a
          // half; at most some 40 slabs a ray.
          EXPECT_NEAR(a, way ? 1.0 - std::exp(-sigma * way->length) : 0.0, 40.0 * 0x1p-22) << x << " " << y;
        }
    }
}

// A linear field has one gradient, in which light is reflected the same way everywhere; its matter is homogeneous.
TEST(hbDvr, LightIsReflectedByGradients) {
  const hbTransferFunction function = transfer({{-9.0, 0.3}, {9.0, 0.3}}, 0.7);
  const glm::dvec3 linear = hb::srgbToLinear(glm::dvec3(0.9, 0.4, 0.1));
  const hbGeometry g = awkward();
  const glm::dvec3 slopes(1.5, -0.5, 0.75);
  const hbVolumeField field = volumeOf(g, [&](const glm::dvec3& p) { return glm::dot(slopes, p); });
  const glm::dmat3 toWorld(glm::transpose(glm::dmat3(glm::inverse(g.cubeToWorld()))));
  for (const bool isPreintegrated : {false, true})
    for (const bool isFar : {false, true})
      for (const hbCamera& camera : cameras(g)) {
        hbScene scene = dvrScene(function, camera, 30);
        scene.preintegrated = isPreintegrated;
        scene.shading.emplace();
        if (isFar) scene.shading->lights = {{{1e9, 2e9, -1e9}, {1.0, 0.5, 2.0}}};
        const hbPicture picture = hbRaycaster(field, scene).render();
        for (int y = 0; y < scene.height; ++y)
          for (int x = 0; x < scene.width; ++x) {
            const std::size_t i = std::size_t(x + scene.width * y);
            const double a = channel(picture, "A")[i];
            const hbRay ray = camera.ray(x + 0.5, y + 0.5, scene.width, scene.height);
            const auto light = scene.shading->reflection({}, ray.direction, toWorld * slopes);
            // Differences of values of up to 3, rounded to 2^-23 of them, over steps of 1/16 to 1/8, turn the normal by
            // less than 1e-4, and the gloss changes by its exponent of 24 times as much; the light's place differs by
            // 1e-8. Slabs: the table's floats.
            for (int c = 0; c < 3; ++c)
              EXPECT_NEAR(colourAt(picture, i)[c], a * (linear[c] * light.matter[c] + light.gloss[c]),
                          2e-4 * (a + 0.01))
                  << x << " " << y;
          }
      }
}

// In a linear field, all matter has the same part of its extinction by the gradient's length.
TEST(hbDvr, OpacityGrowsWithTheGradient) {
  const hbTransferFunction function = transfer({{-9.0, 0.3}, {9.0, 0.3}}, 0.7);
  const hbGeometry g = box({9, 17, 5}, {2.0, 3.0, 1.5});
  const hbVolumeField field = volumeOf(g, [&](const glm::dvec3& p) { return 3.0 * p.x; }); // 1.5 a unit of the world
  for (const bool isPreintegrated : {false, true})
    for (const auto& [range, part] : {std::pair(std::pair(0.0, 1.0), 1.0), {{1.0, 2.0}, 0.5}, {{2.0, 3.0}, 0.0}}) {
      hbScene scene = dvrScene(function, hbCamera::framing(g), 30);
      scene.preintegrated = isPreintegrated;
      scene.gradientOpacity = range;
      const hbPicture picture = hbRaycaster(field, scene).render();
      int seen = 0;
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const auto way = inCube(g, scene, x, y);
          const double length = way ? way->length : 0.0;
          const double expected = 1.0 - std::pow(0.7, part * length / 0.7);
          // Differences of values of up to 3 over steps of 1/8 to 1/4: 3 2^-23 / 0.25 in the gradient, so in the part.
          EXPECT_NEAR(channel(picture, "A")[std::size_t(x + scene.width * y)], expected, 1e-5) << x << " " << y;
          seen += expected > 0.1;
        }
      EXPECT_EQ(seen > 50, part > 0.0);
    }
}

// Of what is seen alone: the invisible half takes none, and nor does what is behind an opaque one.
TEST(hbDvr, GradientsAreTakenOfWhatIsSeen) {
  const hbGeometry g = box({33, 3, 3}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return p.x; });
  const hbTransferFunction function = transfer({{0.0, 0.0}, {0.5, 0.0}, {0.5, 1.0}, {1.0, 1.0}}, 1.0);
  const Counting counting(field);
  hbScene scene = dvrScene(function, alongX(g, true), 64);
  hbRaycaster(counting, scene).render();
  const std::int64_t unlit = counting.asked;
  scene.shading.emplace();
  hbRaycaster(counting, scene).render();
  const std::int64_t gradients = counting.asked - 2 * unlit;
  EXPECT_GT(gradients, 0);
  // One sample of optical depth 36.7 / 64 = 0.57 lets through a half: rays end after 13.
  EXPECT_LE(gradients, 6 * 13 * 19 * 13);
}

// The last slab may end an ulp behind the ray, and be as opaque as floats can say.
TEST(hbDvr, OpaqueSlabsAtTheEndOfARayStayFinite) {
  hbEmissionAbsorption light;
  light.addSlab({1.0F, 1.0F, 1.0F, 1.0F}, -1e-16);
  EXPECT_EQ(light.opacity(), 0.0);
  const hbGeometry g = box({5, 5, 5}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return p.y; });
  hbCamera camera;
  for (int i = 0; i < 200; ++i) {
    camera.position = {0.3 + 0.001 * i, -0.001 * i, 0.4};
    camera.target = {0.5, 1.0, 0.5};
    hbScene scene = dvrScene(transfer({{0.0, 0.0}, {1.0, 1.0}}, 0.2), camera, 7);
    scene.preintegrated = true;
    const hbPicture picture = hbRaycaster(field, scene).render();
    for (const float a : channel(picture, "A")) EXPECT_TRUE(a >= 0.0F && a <= 1.0F) << i << " " << a;
  }
}

TEST(hbDvr, OpaqueRaysEndEarly) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return p.y; });
  for (const double opacity : {0.0, 1.0}) {
    const Counting counting(field);
    const hbScene scene = dvrScene(transfer({{0.0, opacity}, {1.0, opacity}}, 0.01), hbCamera::framing(g), 1000);
    hbRaycaster(counting, scene).render();
    const double rays = 19.0 * 13.0;
    if (opacity > 0.0) {
      EXPECT_LT(double(counting.asked), 100.0 * rays);
    } else {
      EXPECT_GT(double(counting.asked), 100.0 * rays);
    }
  }
}

// Nothing is left of another picture's transfer function.
TEST(hbDvr, EveryTransferFunctionShowsItself) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  const hbCamera camera = hbCamera::framing(g);
  const hbTransferFunction one = transfer({{-1.0, 0.0}, {1.0, 0.7}}, 0.3),
                           other = transfer({{-1.0, 0.7}, {1.0, 0.0}}, 0.3);
  hbScene scene = dvrScene(one, camera, 20);
  const hbPicture first = hbRaycaster(grid, scene).render();
  scene.transfer = other;
  const hbPicture second = hbRaycaster(grid, scene).render();
  scene.transfer = one;
  EXPECT_EQ(hbRaycaster(grid, scene).render().channels, first.channels);
  EXPECT_NE(first.channels, second.channels);
  const double unit = *scene.transfer->definition().unitLength;
  scene.transfer = one.withUnitLength(2.0 * unit);
  EXPECT_NE(hbRaycaster(grid, scene).render().channels, first.channels);
}

// Slabs are integrated anew where the step is another one.
TEST(hbDvr, LooksFromElsewhere) {
  const hbGeometry g = awkward();
  const hbVolumeField field = volumeOf(g, waves);
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene = dvrScene(transfer({{-1.0, 0.0}, {1.0, 0.7}}, 0.3), cameras(g).front(), 20);
    scene.preintegrated = isPreintegrated;
    hbRaycaster moved(field, scene);
    for (const hbCamera& camera : cameras(g)) {
      moved.look(camera);
      scene.camera = camera;
      EXPECT_EQ(moved.render().channels, hbRaycaster(field, scene).render().channels);
    }
    hbCamera wrong;
    wrong.target = wrong.position;
    EXPECT_THROW(moved.look(wrong), hbError);
  }
}

TEST(hbDvr, NeedsATransferFunctionWithAUnit) {
  const hbGeometry g = box({3, 3, 3}, {1.0, 1.0, 1.0});
  const hbVolumeField field = volumeOf(g, [](const glm::dvec3& p) { return p.x; });
  hbScene scene = sceneOf(hbMode::dvr, hbCamera::framing(g));
  EXPECT_THROW(hbRaycaster(field, scene), hbError);
  scene.transfer = hbTransferFunction::preset("density");
  EXPECT_THROW(hbRaycaster(field, scene), hbError);
  scene.transfer = scene.transfer->withUnitLength(1.0);
  EXPECT_NO_THROW(hbRaycaster(field, scene));
}
