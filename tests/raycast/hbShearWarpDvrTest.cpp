// Emission and absorption by shear-warp.

#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "raycast/hbMatter.h"
#include "raycast/hbRaycaster.h"
#include "raycast/hbShearReference.h"
#include "raycast/hbSliceLight.h"
#include "scene/hbColorSpace.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbDvrScenes.h"
#include "tests/raycast/hbTestScenes.h"
#include "volume/hbError.h"
#include "volume/hbMagnitudeField.h"

using namespace hbTestScenes;

namespace {

constexpr std::array<const char*, 5> kChannels{"R", "G", "B", "A", "Y"};

/// Of cameras(): parallel rays from an angle, and a wide view from within. Tables of slabs take time.
bool isOblique(std::size_t camera) { return camera == 6 || camera == 22; }

/// The same colour and opacity for all values.
hbTransferFunction fog(double opacity, double unitLength, const glm::dvec3& rgb = {0.9, 0.4, 0.1}) {
  hbTransferFunction::Definition d;
  d.colors = {{0.0, rgb}, {1.0, rgb}};
  d.opacities = {{0.0, opacity}, {1.0, opacity}};
  d.unitLength = unitLength;
  return hbTransferFunction(std::move(d));
}

/// The greatest change of a channel and of the extinction over the value, those of a table's entries.
struct Slopes {
  double colour = 0.0, extinction = 0.0;

  explicit Slopes(const hbTransferFunction& function) {
    const hbTransferTable table(function);
    const auto [lo, hi] = table.range();
    for (std::size_t k = 0; k + 1 < table.entries().size(); ++k) {
      const glm::dvec4 change = glm::dvec4(glm::abs(table.entries()[k + 1] - table.entries()[k])) *
                                double(table.entries().size() - 1) / (hi - lo);
      colour = std::max({colour, change.r, change.g, change.b});
      extinction = std::max(extinction, change.a);
    }
  }
};

/// An intermediate ray, one value after the other.
struct RayLight {
  hbEmissionAbsorption light;
  double length = 0.0;
  std::size_t slices = 0;
};

RayLight lightOf(hbShearReference& reference, const hbMatter& matter, const hbShearReference::Neighbour& n) {
  const hbShearReference::Samples& s = reference.samples(*n.rays, n.i, n.j);
  RayLight ray;
  ray.slices = s.values.size();
  if (s.values.empty()) return ray;
  const glm::dvec3 way = reference.slabOf(*n.rays, n.i, n.j, s.first);
  const double slab = glm::length(glm::inverse(glm::dmat3(reference.rays().worldToCube())) * way);
  ray.length = slab * (s.before + s.after + double(s.values.size() - 1));
  for (std::size_t k = 0; k < s.values.size(); ++k) {
    const bool isFirst = k == 0, isLast = k + 1 == s.values.size();
    const auto value = float(s.values[k]);
    if (!matter.isPreintegrated()) {
      matter.add(value, slab * ((isFirst ? s.before : 0.5) + (isLast ? s.after : 0.5)), ray.light);
      continue;
    }
    if (isFirst)
      matter.add(value, slab * s.before, ray.light);
    else
      matter.addSlab(float(s.values[k - 1]), value, slab, ray.light);
    if (isLast) matter.add(value, slab * s.after, ray.light);
  }
  return ray;
}

/// Compares every pixel with what intermediate rays see, each as constant matter over the pixel's own length, blended.
int expectReference(const hbSparseGrid& grid, const hbScene& scene, int supersample = 1) {
  hbShearReference reference(grid, scene, supersample);
  const double step = scene.sampling.stepLength(grid.geometry(), *reference.scene().camera);
  const hbMatter matter(reference.scene(), {}, step);
  const Slopes slopes(*scene.transfer);
  const hbPicture picture = draw(grid, scene, supersample);
  int seen = 0;
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) {
      const auto in = inCube(grid.geometry(), reference.scene(), x, y);
      glm::dvec4 sum(0.0);
      double weights = 0.0, tolerance = 0x1p-22;
      // A value's rounding moves a channel by its slope and the depth by the extinction's, see below.
      double perValue = reference.rounding();
      for (const auto& n : reference.neighbours(x + 0.5, y + 0.5)) {
        if (!in) break;
        const RayLight ray = lightOf(reference, matter, n);
        if (ray.slices == 0) continue;
        weights += n.weight;
        const double through = std::pow(ray.light.transmittance(), in->length / ray.length);
        if (ray.light.opacity() > 0.0)
          sum += n.weight * (1.0 - through) * glm::dvec4(ray.light.colour() / ray.light.opacity(), 1.0);
        // Rays end where nearly nothing is seen any more.
        if (ray.light.transmittance() < hbSliceLight::kOpaque * 1.001)
          tolerance = std::max(tolerance, std::pow(hbSliceLight::kOpaque, in->length / ray.length));
      }
      if (weights > 0.0) {
        sum /= weights;
      } else if (in) {
        hbEmissionAbsorption light;
        matter.add(float(reference.value(0.5 * (in->enter + in->leave))), in->length, light);
        sum = glm::dvec4(light.colour(), light.opacity());
        perValue += glm::dot(reference.slopes(), glm::dvec3(0x1p-24));
      }
      // The light of a ray is an integral of colour over opacity, at most 1: a channel moves by no more than colours
      // do, and what depths change it by is no more than the depth's own change. The same for slabs, whose entries lie
      // between those of the values they span, and twice that for the two ends.
      if (in) tolerance += 2.0 * perValue * (slopes.colour + slopes.extinction * in->length) + 4e-9;
      const std::size_t at = std::size_t(x + scene.width * y);
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(channel(picture, kChannels[std::size_t(c)])[at], sum[c], tolerance) << x << " " << y << " " << c;
      EXPECT_NEAR(channel(picture, "Y")[at], hb::linearToXyz(glm::dvec3(sum)).y, tolerance) << x << " " << y;
      seen += sum.a > 0.01;
    }
  return seen;
}

/// The greatest difference in any channel, and the root of the mean square.
struct Difference {
  double greatest = 0.0, rms = 0.0;

  Difference(const hbPicture& a, const hbPicture& b) {
    std::size_t count = 0;
    for (const char* name : kChannels) {
      const std::vector<float> one = channel(a, name), other = channel(b, name);
      for (std::size_t i = 0; i < one.size(); ++i) {
        const double difference = std::abs(double(one[i]) - double(other[i]));
        greatest = std::max(greatest, difference);
        rms += difference * difference;
      }
      count += one.size();
    }
    rms = std::sqrt(rms / double(count));
  }
};

} // namespace

TEST(hbEmissionAbsorption, PiecesShowWhatTheWholeDoes) {
  hbEmissionAbsorption whole, front, back;
  const std::array<glm::vec4, 4> layers{
      glm::vec4{1.0F, 0.5F, 0.0F, 2.0F}, {0.0F, 0.2F, 1.0F, 0.5F}, {0.3F, 0.0F, 0.1F, 1.5F}, {0.0F, 0.5F, 1.0F, 1.0F}};
  for (std::size_t i = 0; i < layers.size(); ++i) {
    whole.add(layers[i], 0.4);
    (i < 2 ? front : back).add(layers[i], 0.4);
  }
  front.add(back);
  EXPECT_NEAR(front.transmittance(), whole.transmittance(), 1e-15);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(front.colour()[c], whole.colour()[c], 1e-15);
  hbEmissionAbsorption constant;
  constant.add(whole.matter(3.0), 3.0);
  EXPECT_NEAR(constant.transmittance(), whole.transmittance(), 0x1p-23); // a depth below 2, as a float
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(constant.colour()[c], whole.colour()[c], 0x1p-22);
  EXPECT_EQ(hbEmissionAbsorption().matter(2.0), glm::vec4(0.0F));
  hbEmissionAbsorption black;
  black.add({0.0F, 0.0F, 0.0F, 1e30F}, 1.0);
  EXPECT_GT(black.matter(1.0).a, 700.0F);
  EXPECT_TRUE(std::isfinite(black.matter(1.0).a));
}

TEST(hbVisibility, WhatIsInvisibleShowsNothing) {
  hbTransferFunction::Definition d;
  d.colors = {{0.0, glm::dvec3(1.0)}};
  d.opacities = {{0.0, 0.0}, {0.4, 0.0}, {0.4, 0.5}, {0.41, 0.5}, {0.41, 0.0}, {0.9, 0.0}, {1.0, 1.0}};
  d.unitLength = 1.0;
  const hbTransferFunction function(d);
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene;
    scene.transfer = function;
    scene.preintegrated = isPreintegrated;
    const hbMatter matter(scene, {}, 0.1);
    const hbVisibility visibility(function, matter);
    int invisible = 0;
    // Several values a cell of either table.
    for (int a = -4000; a <= 24000; ++a)
      for (const int width : {0, 1, 2400}) {
        const float least = float(a) / 20000.0F, greatest = float(a + width) / 20000.0F;
        if (!visibility.isInvisible(least, greatest)) continue;
        ++invisible;
        hbEmissionAbsorption light;
        for (const float value : {least, 0.5F * (least + greatest), greatest}) matter.add(value, 1.0, light);
        if (isPreintegrated) matter.addSlab(least, greatest, 1.0, light);
        if (isPreintegrated) matter.addSlab(greatest, least, 1.0, light);
        EXPECT_EQ(light.opacity(), 0.0) << least << " " << greatest;
      }
    // But for the step and the ramp, before which some lie within their width, and for margins.
    EXPECT_GT(invisible, 50000);
    EXPECT_FALSE(visibility.isInvisible(0.0F, 1.0F));
  }
  d.nanOpacity = 0.5;
  hbScene showsHoles;
  showsHoles.transfer = hbTransferFunction(d);
  EXPECT_FALSE(hbVisibility(*showsHoles.transfer, hbMatter(showsHoles, {}, 1.0)).isInvisible(0.0F, 0.1F));
}

TEST(hbShearWarpDvr, IsTheReference) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    int seen = 0;
    const std::vector<hbCamera> list = cameras(g);
    for (std::size_t k = 0; k < list.size(); ++k)
      for (const bool isPreintegrated : {false, true}) {
        if (isPreintegrated && !isOblique(k)) continue;
        const hbCamera& camera = list[k];
        SCOPED_TRACE(testing::Message() << "camera at " << camera.position.x << " " << camera.position.y << " "
                                        << camera.position.z << " projection " << int(camera.projection));
        hbScene scene = dvrScene(ramp(0.5), camera, 9);
        scene.preintegrated = isPreintegrated;
        seen += expectReference(grid, scene);
        if (testing::Test::HasFailure()) return;
      }
    EXPECT_GT(seen, 19 * 13 * 10);
  }
}

TEST(hbShearWarpDvr, ClipBoxesAreTheReference) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  const std::vector<hbCamera> list = cameras(awkward());
  for (const hbScene::ClipBox& clip : clipBoxes()) {
    int seen = 0;
    for (std::size_t k = 0; k < list.size(); ++k)
      for (const bool isPreintegrated : {false, true}) {
        if (isPreintegrated && !isOblique(k)) continue;
        SCOPED_TRACE(testing::Message() << "camera " << k << " box from " << clip.lo.x << " " << clip.lo.y);
        hbScene scene = dvrScene(ramp(0.5), list[k], 20);
        scene.clip = clip;
        scene.preintegrated = isPreintegrated;
        seen += expectReference(grid, scene);
        if (testing::Test::HasFailure()) return;
      }
    EXPECT_GT(seen, 19 * 13);
  }
}

// Bands of rays and chunks of slices join without a seam, opaque or not.
TEST(hbShearWarpDvr, LargePicturesAreTheReference) {
  const hbSparseGrid grid = gridOf(box({3, 3, 3}, {1.0, 1.0, 1.0}), 1, {waves});
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene = dvrScene(ramp(0.5), hbCamera::framing(grid.geometry(), 20.0, 15.0), 3);
    scene.preintegrated = isPreintegrated;
    scene.width = 40;
    scene.height = 330;
    EXPECT_GT(expectReference(grid, scene, 2), 0);
    scene = dvrScene(ramp(0.05), hbCamera::framing(grid.geometry(), 0.0, 0.0), 150);
    scene.preintegrated = isPreintegrated;
    EXPECT_GT(expectReference(grid, scene), 0);
  }
}

TEST(hbShearWarpDvr, ShowsComponentsTheirLengthAndTrueValues) {
  const auto other = [](const glm::dvec3& p) { return 0.5 - p.x * p.y; };
  const hbGeometry g = box({9, 9, 9}, {1.0, 2.0, 1.0});
  const hbSparseGrid two = gridOf(g, 3, {waves, other});
  hbScene scene = dvrScene(ramp(0.5), hbCamera::framing(g, 35.0, 20.0), 9);
  for (const bool isMagnitude : {false, true})
    for (const int component : {0, 1}) {
      scene.magnitude = isMagnitude;
      scene.component = isMagnitude ? 0 : component;
      EXPECT_GT(expectReference(two, scene), 0);
    }
  // A common offset that the grid's value map takes away.
  const hbSparseGrid far = gridOf(g, 3, {[](const glm::dvec3& p) { return 1e9 + waves(p); }});
  EXPECT_NE(far.valueMap().offset, 0.0);
  scene = dvrScene(ramp(0.5).rescaled(1e9 - 2000.0, 1e9 + 2000.0), hbCamera::framing(g, 35.0, 20.0), 9);
  EXPECT_GT(expectReference(far, scene), 0);
}

// exp(-sigma d), whatever the camera, the step and the spacing: every ray is the same matter over another length.
TEST(hbShearWarpDvr, AHomogeneousMediumIsExact) {
  constexpr double kOpacity = 0.3, kUnit = 0.7;
  const double sigma = -std::log(1.0 - kOpacity) / kUnit;
  const glm::dvec3 linear = hb::srgbToLinear(glm::dvec3(0.9, 0.4, 0.1));
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {[](const glm::dvec3&) { return 0.5; }});
    int seen = 0;
    const std::vector<hbCamera> list = cameras(g);
    for (std::size_t k = 0; k < list.size(); ++k)
      for (const auto& [samples, clip] : {std::pair(1, 0), {7, 0}, {60, 0}, {7, 1}, {7, 2}, {60, 3}})
        for (const bool isPreintegrated : {false, true}) {
          if (isPreintegrated && !(isOblique(k) && samples == 7)) continue;
          const hbCamera& camera = list[k];
          hbScene scene = dvrScene(fog(kOpacity, kUnit), camera, samples);
          scene.clip = clipBoxes()[std::size_t(clip)];
          scene.preintegrated = isPreintegrated;
          const hbPicture picture = draw(grid, scene);
          for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
              const std::size_t i = std::size_t(x + scene.width * y);
              const auto way = inCube(g, scene, x, y);
              const double depth = way ? sigma * way->length : 0.0, expected = 1.0 - std::exp(-depth);
              // The extinction is a float twice, and what is shown; a slab's opacity a is off by 2^-23 between entries,
              // which changes the depth by that over a (1 - a) of itself.
              const double step = sigma * scene.sampling.stepLength(g, camera);
              const double ofDepth = isPreintegrated ? 0x1p-23 / (-std::expm1(-step) * std::exp(-step)) : 0x1p-23;
              const double tolerance = (1.0 - expected) * std::expm1(depth * (ofDepth + 0x1p-22)) + 0x1p-24;
              ASSERT_NEAR(channel(picture, "A")[i], expected, tolerance) << x << " " << y << " " << isPreintegrated;
              for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(channel(picture, kChannels[std::size_t(c)])[i], linear[c] * expected, tolerance + 0x1p-22);
              seen += expected > 0.0;
            }
        }
    EXPECT_GT(seen, 19 * 13 * 20);
  }
}

// A ray's light is that of its values at shares of its way. Where they differ by no more than e, extinctions differ by
// E e and depths, up to any share, by D = E e L; light by what colours differ by, by D, and by D e^D for what the
// different depths before let through. Rays beside a pixel's are stretched to its length: with a share t of a depth
// before it, light changes by a factor of at most (L / l)^depth and back.
TEST(hbShearWarpDvr, IsWithinADerivedBoundOfRayCasting) {
  const auto slow = [](const glm::dvec3& p) { return 0.2 * p.x - 0.1 * p.y + 0.1 * p.z * p.x; };
  hbTransferFunction::Definition d;
  d.colors = {{-0.3, {0.6, 0.4, 0.3}}, {0.5, {0.4, 0.5, 0.6}}};
  d.opacities = {{-0.3, 0.0}, {0.5, 0.4}};
  d.unitLength = 1.0;
  const hbTransferFunction gentle(std::move(d));
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {slow});
    int covered = 0, near = 0;
    for (const hbCamera& camera : cameras(g)) {
      hbScene scene = dvrScene(gentle, camera, 100);
      const Slopes slopes(*scene.transfer);
      hbShearReference reference(grid, scene, 4);
      const hbPicture warped = draw(grid, scene, 4), cast = hbRaycaster(grid, scene).render();
      const glm::dvec3 steepest = reference.slopes();
      const auto change = [&](const glm::dvec3& way) { return glm::dot(steepest, glm::abs(way)); };
      const double rounding = reference.rounding() + hb::directBound(grid) + change(glm::dvec3(0x1p-24));
      const double step = scene.sampling.stepLength(g, camera);
      const hbMatter matter(scene, {}, step);
      for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
          const auto in = inCube(g, scene, x, y);
          if (!in) continue;
          ++covered;
          const glm::dvec3 whole = in->leave - in->enter;
          double bound = 0.0, e = change(whole);
          for (const auto& n : reference.neighbours(x + 0.5, y + 0.5)) {
            const hbShearReference::Samples& s = reference.samples(*n.rays, n.i, n.j);
            if (s.values.empty()) continue;
            const int last = s.first + int(s.values.size()) - 1;
            const glm::dvec3 first = hbShearReference::point(*n.rays, n.i, n.j, s.first),
                             far = hbShearReference::point(*n.rays, n.i, n.j, last),
                             way = reference.slabOf(*n.rays, n.i, n.j, s.first);
            // A value stands for points within a slab, or half a step.
            e = std::max(change(in->enter - (first - s.before * way)), change(in->leave - (far + s.after * way))) +
                change(way) + 0.5 * change(whole / std::ceil(in->length / step)) + rounding;
            const RayLight ray = lightOf(reference, matter, n);
            const double depth = -std::log(ray.light.transmittance());
            const double depths = slopes.extinction * e * in->length;
            bound = std::max(bound, slopes.colour * e + depths * (1.0 + std::exp(depths)) +
                                        std::expm1(depth * std::abs(std::log(in->length / ray.length))));
          }
          const double depths = slopes.extinction * e * in->length;
          if (bound == 0.0) bound = slopes.colour * e + depths * (1.0 + std::exp(depths)); // one value for it all
          const std::size_t at = std::size_t(x + scene.width * y);
          for (const char* name : kChannels) {
            const double difference = std::abs(channel(warped, name)[at] - channel(cast, name)[at]);
            ASSERT_LE(difference, bound + hbEmissionAbsorption::kOpaque) << x << " " << y << " " << name;
          }
          near += bound < 0.3;
        }
    }
    EXPECT_GT(covered, 19 * 13 * 10);
    EXPECT_GT(near, covered / 2); // the bound says something
  }
}

// Rays and slices four times as close: of the first order at least, where rays beside a pixel's meet other faces of the
// box, or kinks of the field or the function; of the second in between.
TEST(hbShearWarpDvr, ConvergesToRayCasting) {
  const hbSparseGrid grid = gridOf(awkward(), 4, {waves});
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    hbScene scene = dvrScene(ramp(2.0), hbCamera::framing(awkward(), 35.0, 20.0, projection), 640);
    scene.width = scene.height = 40;
    const hbPicture cast = hbRaycaster(grid, scene).render();
    for (const bool isPreintegrated : {false, true}) {
      scene.preintegrated = isPreintegrated;
      const auto error = [&](int supersample) {
        scene.sampling.samples = 40 * supersample;
        return Difference(draw(grid, scene, supersample), cast).rms;
      };
      EXPECT_LT(error(4), 0.25 * error(1));
    }
  }
}

// Red before blue from one side, blue before red from the other.
TEST(hbShearWarpDvr, WhatIsInFrontHidesWhatIsBehind) {
  const hbGeometry g = box({65, 3, 3}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 6, {[](const glm::dvec3& p) { return p.x; }});
  hbTransferFunction::Definition d;
  d.colors = {{0.0, {1.0, 0.0, 0.0}}, {0.5, {1.0, 0.0, 0.0}}, {0.5, {0.0, 0.0, 1.0}}, {1.0, {0.0, 0.0, 1.0}}};
  d.opacities = {{0.0, 0.8}, {1.0, 0.8}};
  d.unitLength = 0.5;
  const hbTransferFunction function(std::move(d));
  for (const bool isPreintegrated : {false, true})
    for (const bool isForward : {true, false}) {
      const hbCamera camera = hbCamera::framing(g, isForward ? -90.0 : 90.0, 0.0, Projection::orthographic);
      hbScene scene = dvrScene(function, camera, 64);
      scene.preintegrated = isPreintegrated;
      const hbPicture picture = draw(grid, scene);
      const std::size_t middle = 19 * 6 + 9;
      const double red = channel(picture, "R")[middle], blue = channel(picture, "B")[middle];
      // Half of the way each; a slab in which the colour changes could be either's, which moves the border by 1/64 of
      // the way, and light by that times the extinction ln(5) / 0.5.
      const double moved = std::log(5.0) / 0.5 / 64.0;
      EXPECT_NEAR(isForward ? red : blue, 0.8, moved);
      EXPECT_NEAR(isForward ? blue : red, 0.2 * 0.8, moved);
      EXPECT_NEAR(red + blue, 1.0 - 0.2 * 0.2, 64.0 * 0x1p-22);
    }
}

// A shell of opacity thinner than a step: slices may miss it, slabs do not.
TEST(hbShearWarpDvr, PreintegratedSlabsMeetWhatSlicesMiss) {
  const hbGeometry g = box({17, 17, 17}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 4, {[](const glm::dvec3& p) { return glm::length(p - glm::dvec3(0.5)); }});
  hbTransferFunction::Definition d;
  d.colors = {{0.0, {1.0, 0.2, 0.1}}, {0.3, {1.0, 0.9, 0.1}}, {0.31, {0.1, 0.2, 1.0}}, {1.0, {0.1, 1.0, 1.0}}};
  d.opacities = {{0.0, 0.0}, {0.3, 0.0}, {0.305, 0.9}, {0.31, 0.0}, {1.0, 0.0}};
  d.unitLength = 0.01;
  const hbTransferFunction function(std::move(d));
  const auto drawn = [&](int samples, bool isPreintegrated) {
    hbScene scene = dvrScene(function, hbCamera::framing(g, 30.0, 20.0), samples);
    scene.preintegrated = isPreintegrated;
    return draw(grid, scene);
  };
  const hbPicture reference = drawn(10000, false);
  for (const int samples : {64, 128, 256})
    EXPECT_LE(Difference(drawn(samples / 4, true), reference).rms, Difference(drawn(samples, false), reference).rms)
        << samples;
  EXPECT_LT(Difference(drawn(1024, true), reference).rms, 0.003);
}

// Nothing is left of another picture's transfer function, nor of the frame before.
TEST(hbShearWarpDvr, EveryTransferFunctionShowsItself) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene = dvrScene(ramp(0.5), hbCamera::framing(awkward()), 20);
    scene.preintegrated = isPreintegrated;
    const hbPicture first = draw(grid, scene);
    scene.transfer = ramp(0.5).withUnitLength(0.1);
    const hbShearWarp other(grid, scene, {});
    const hbPicture second = other.render();
    EXPECT_NE(second.channels, first.channels);
    EXPECT_EQ(other.render().channels, second.channels);
    scene.transfer = ramp(0.5);
    EXPECT_EQ(draw(grid, scene).channels, first.channels);
  }
}

TEST(hbShearWarpDvr, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const hbSparseGrid grid = gridOf(box({5, 5, 5}, {1.0, 1.0, 1.0}), 2, {waves});
  for (const auto& [isPreintegrated, isLit] : {std::pair(false, false), {true, false}, {false, true}, {true, true}}) {
    // More rays than a round of bands has, more slices than a chunk.
    hbScene scene = dvrScene(ramp(), hbCamera::framing(grid.geometry(), 30.0, 20.0), 20);
    scene.preintegrated = isPreintegrated;
    if (isLit) scene.shading.emplace();
    scene.width = 190;
    scene.height = 180;
    std::map<std::string, std::vector<float>> first;
    for (const std::size_t threads : {1U, 2U, 7U}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
      const hbPicture picture = draw(grid, scene, 3);
      if (first.empty()) first = picture.channels;
      EXPECT_TRUE(picture.channels == first) << threads;
    }
  }
}

// A linear field has one gradient, one-sided at the faces, too: light alone changes along a ray. With parallel rays
// that see light from far away even that is one number, and lit fog is the fog times it.
TEST(hbShearWarpDvr, ALinearFieldIsLitAsItsGradientSays) {
  const glm::dvec3 ofCube(0.2, -0.15, 0.1);
  const auto linear = [&](const glm::dvec3& p) { return 0.4 + glm::dot(ofCube, p); };
  hbShading shading;
  shading.lights = {{glm::dvec3(3e6, -4e6, 2e6), glm::dvec3(0.9, 0.8, 0.7)}};
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {linear});
    const glm::dvec3 gradient = glm::transpose(glm::inverse(glm::dmat3(g.cubeToWorld()))) * ofCube;
    const std::vector<hbCamera> list = cameras(g);
    for (const std::size_t k : {0U, 4U, 6U, 8U}) // orthographic
      for (const bool isPreintegrated : {false, true})
        for (const std::size_t clip : {0U, 1U, 2U}) {
          if (isPreintegrated && !(isOblique(k) && clip == 1)) continue; // tables of slabs take time
          hbScene scene = dvrScene(fog(0.3, 0.7), list[k], 20);
          scene.preintegrated = isPreintegrated;
          scene.clip = clipBoxes()[clip];
          const hbPicture plain = draw(grid, scene);
          scene.shading = shading;
          const hbPicture lit = draw(grid, scene);
          EXPECT_EQ(channel(lit, "A"), channel(plain, "A"));
          const hbShading::Reflection reflection = shading.reflection(
              glm::dvec3(g.cubeToWorld() * glm::dvec4(0.5, 0.5, 0.5, 1.0)), list[k].viewAxis(), gradient);
          // A slope is off by two values' roundings over at least one spacing: 16 times as much, and of the world by
          // the steepest row of the map, 1 / 1.5; over the gradient's length the normal is. Light turns with the
          // normal, gloss by its exponent; the volume's own size changes the light's direction by 3 / 5e6.
          const double rounding = hbShearReference(grid, scene).rounding();
          const double turned = 16.0 * 2.0 * rounding / glm::length(gradient) + 1e-6;
          const double tolerance = (1.0 + shading.diffuse + shading.specular * shading.shininess) * turned + 0x1p-22;
          int seen = 0;
          for (std::size_t i = 0; i < channel(plain, "A").size(); ++i)
            for (int c = 0; c < 3; ++c) {
              const double colour = channel(plain, kChannels[std::size_t(c)])[i], opacity = channel(plain, "A")[i];
              ASSERT_NEAR(channel(lit, kChannels[std::size_t(c)])[i],
                          colour * reflection.matter[c] + opacity * reflection.gloss[c], tolerance)
                  << k << " " << isPreintegrated << " " << clip;
              seen += opacity > 0.1;
            }
          EXPECT_GT(seen, clip == 2 ? -1 : 3 * 10);
        }
  }
}

// Half-way up the ramp of opacities half of the extinction is left, of a linear field everywhere.
TEST(hbShearWarpDvr, GradientOpacityTakesExtinctionAway) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 2.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {[](const glm::dvec3& p) { return 0.25 + 0.5 * p.x; }});
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene = dvrScene(fog(0.3, 0.7), hbCamera::framing(g, 30.0, 20.0), 20);
    scene.preintegrated = isPreintegrated;
    const std::vector<float> plain = channel(draw(grid, scene), "A");
    scene.gradientOpacity = {{0.25, 0.75}};
    const std::vector<float> half = channel(draw(grid, scene), "A");
    scene.gradientOpacity = {{0.6, 0.75}};
    for (const float a : channel(draw(grid, scene), "A")) EXPECT_EQ(a, 0.0F);
    // Two values' roundings over two spacings of 1/8 (at a face one), over the ramp's 1/2: extinction changes by 32 of
    // them, depths (below 2) by twice as much.
    const double tolerance = 2.0 * 32.0 * hbShearReference(grid, scene).rounding() + 0x1p-22;
    for (std::size_t i = 0; i < plain.size(); ++i)
      EXPECT_NEAR(half[i], 1.0 - std::sqrt(1.0 - double(plain[i])), tolerance);
  }
}

// Lit pieces of rays are those of ray casting: with rays and slices as close as its own the difference goes down.
TEST(hbShearWarpDvr, LitPicturesConvergeToRayCasting) {
  const auto other = [](const glm::dvec3& p) { return 0.5 - p.x * p.y; };
  const hbSparseGrid grid = gridOf(awkward(), 4, {waves, other});
  for (const auto& [projection, isPreintegrated] :
       {std::pair(Projection::orthographic, true), {Projection::perspective, false}}) {
    hbScene scene = dvrScene(ramp(2.0), hbCamera::framing(awkward(), 35.0, 20.0, projection), 320);
    scene.width = scene.height = 24;
    scene.preintegrated = isPreintegrated;
    scene.shading.emplace();
    scene.gradientOpacity = {{0.2, 2.0}};
    scene.clip = {{0.1, 0.0, 0.2}, {1.0, 0.8, 0.9}};
    const hbPicture cast = hbRaycaster(grid, scene).render();
    hbScene unlit = scene;
    unlit.shading.reset();
    unlit.gradientOpacity.reset();
    const double ofLight = Difference(hbRaycaster(grid, unlit).render(), cast).rms;
    const auto error = [&](int supersample) {
      scene.sampling.samples = 40 * supersample;
      return Difference(draw(grid, scene, supersample), cast).rms;
    };
    // Of the first order at least, and a small part of what light is.
    EXPECT_LT(error(4), 0.25 * error(1));
    EXPECT_LT(error(4), 0.1 * ofLight);
  }
}

// Along an axis slices are the planes of planewise ray casting, and pixels have rays of their own.
TEST(hbShearWarpDvr, LitAlongAnAxisItIsPlanewiseRayCasting) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const auto other = [](const glm::dvec3& p) { return 0.5 - p.x * p.y; };
  const hbSparseGrid grid = gridOf(g, 3, {waves, other});
  for (const double azimuth : {0.0, 90.0})
    for (const bool isMagnitude : {false, true}) {
      hbScene scene = dvrScene(ramp(0.5), hbCamera::framing(g, azimuth, 0.0, Projection::orthographic), 20,
                               hbSampling::Kind::planewise);
      scene.shading.emplace();
      scene.gradientOpacity = {{0.2, 2.0}};
      scene.magnitude = isMagnitude;
      const hbPicture lit = draw(grid, scene);
      const auto field = std::shared_ptr<const hbField>(std::shared_ptr<const hbField>(), &grid);
      const hbMagnitudeField length(field);
      scene.magnitude = false;
      const hbPicture cast = isMagnitude ? hbRaycaster(length, scene).render() : hbRaycaster(grid, scene).render();
      // Slopes are off by 16 values' roundings, two over a spacing; the caster's places are rounded, too. Gradients
      // below 0.2 show nothing, so that the normal turns by no more than that over 0.2, and light, at most 1.3, by 0.8
      // and 0.2 times 24 of it. Extinctions are at most ln(10) / 0.5, and change by a 1.8th over the ramp of gradients;
      // the way is 1. Rays end where nearly nothing is seen any more.
      const hbShearReference reference(grid, scene);
      const double rounding =
          reference.rounding() + hb::directBound(grid) + glm::dot(reference.slopes(), glm::dvec3(0x1p-24));
      const Slopes slopes(*scene.transfer);
      const double ofSlopes = 16.0 * rounding * ((0.8 + 0.2 * 24.0) / 0.2 + 1.3 * std::log(10.0) / 0.5 / 1.8);
      const double tolerance = ofSlopes + 1.3 * rounding * (slopes.colour + slopes.extinction) +
                               1.3 * hbEmissionAbsorption::kOpaque + 0x1p-22;
      EXPECT_LE(Difference(lit, cast).greatest, tolerance) << azimuth << " " << isMagnitude;
    }
}

TEST(hbShearWarpDvr, SaysWhatItTakes) {
  const hbSparseGrid grid = gridOf(box({9, 9, 9}, {1.0, 1.0, 1.0}), 3, {waves});
  hbScene scene = dvrScene(ramp(), hbCamera::framing(grid.geometry()), 20);
  const double samples = hbShearWarp(grid, scene, {}).bytes();
  // A table, and at least the rays and one chunk of them; pre-integrated, a table of pairs.
  EXPECT_GE(samples, 16.0 * hbTransferTable::kDefaultEntries + (16.0 + 32.0) * 19 * 13);
  scene.preintegrated = true;
  const double slabs = hbShearWarp(grid, scene, {}).bytes();
  EXPECT_GE(slabs - samples, 16.0 * (1024.0 * 1024.0 - hbTransferTable::kDefaultEntries));
  scene.shading.emplace();
  EXPECT_GT(hbShearWarp(grid, scene, {}).bytes(), slabs); // slopes
}

// Nothing is left of where it was seen from before.
TEST(hbShearWarpDvr, LitPicturesLookFromElsewhere) {
  const hbSparseGrid grid = gridOf(awkward(), 3, {waves});
  hbScene scene = dvrScene(ramp(0.5), cameras(awkward()).front(), 20);
  scene.shading.emplace();
  hbShearWarp moved(grid, scene, {1});
  for (const hbCamera& camera : cameras(awkward())) {
    moved.look(camera);
    scene.camera = camera;
    EXPECT_EQ(moved.render().channels, draw(grid, scene).channels);
  }
}

TEST(hbShearWarpDvr, SeesNothingWhereThereIsNothing) {
  const hbSparseGrid grid = gridOf(box({9, 9, 9}, {1.0, 1.0, 1.0}), 3, {waves});
  hbCamera away;
  away.position = {0.5, 2.0, 0.5};
  away.target = {0.5, 3.0, 0.5};
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    away.projection = projection;
    const hbPicture picture = draw(grid, dvrScene(ramp(), away, 9));
    for (const char* name : kChannels) EXPECT_EQ(channel(picture, name), std::vector<float>(19 * 13, 0.0F));
  }
}

TEST(hbShearWarpDvr, RefusesWhatHasNoOpacity) {
  const hbSparseGrid grid = gridOf(box({9, 9, 9}, {1.0, 1.0, 1.0}), 3, {waves});
  hbScene scene = dvrScene(hbTransferFunction::preset("density"), hbCamera::framing(grid.geometry()), 9);
  const auto refusal = [&]() -> std::string {
    try {
      hbShearWarp(grid, scene, {});
    } catch (const hbError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(), "dvr: expected a transfer function that states its unit length");
  scene.transfer.reset();
  EXPECT_EQ(refusal(), "dvr: expected a transfer function that states its unit length");
  scene.transfer = ramp();
  EXPECT_EQ(refusal(), "");
}

TEST(hbShearWarpDvr, StopsWhenCancelled) {
  const hbSparseGrid grid = gridOf(box({9, 9, 9}, {1.0, 1.0, 1.0}), 3, {waves});
  hbProgress progress;
  progress.cancel();
  const hbShearWarp warp(grid, dvrScene(ramp(), hbCamera::framing(grid.geometry()), 9), {});
  EXPECT_THROW(warp.render(progress), hbCancelled);
}
