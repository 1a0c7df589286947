#include "raycast/hbRaycaster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <rapidcheck/gtest.h>

#include "raycast/hbRaySegment.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace {

/// A function of the cube as a field, for tests that need one exactly.
class FunctionField final : public hbField {
public:
  FunctionField(const hbGeometry& geometry, std::function<double(const glm::dvec3&)> f)
      : geometry_(geometry), f_(std::move(f)) {}
  const hbGeometry& geometry() const override { return geometry_; }
  int components() const override { return 1; }
  void values(const hbPoints& points, int, std::span<float> out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = float(f_({points.x[i], points.y[i], points.z[i]}));
  }
  void gradients(const hbPoints&, int, std::span<float>, const hbGradients&) const override {
    FAIL() << "the ray caster takes central differences";
  }
  hbRange range(const hbBox&, int) const override { return {-1e30F, 1e30F}; }

private:
  hbGeometry geometry_;
  std::function<double(const glm::dvec3&)> f_;
};

/// A cube of `nodes` samples an axis that spans [0,1] in world space.
hbGeometry unitGeometry(std::int64_t nodes) {
  hbGeometry g;
  g.size = hbSize3(nodes);
  g.spacing = glm::dvec3(1.0 / double(nodes - 1));
  return g;
}

/// A box of unequal edges, turned and shifted.
hbGeometry obliqueGeometry() {
  hbGeometry g;
  g.size = {9, 17, 5};
  g.spacing = {0.5, 0.125, 2.0};
  g.origin = {3.0, -1.0, 2.0};
  const double c = std::cos(0.5), s = std::sin(0.5);
  g.direction = glm::dmat3(glm::dvec3(c, s, 0), glm::dvec3(-s, c, 0), glm::dvec3(0, 0, 1));
  return g;
}

hbScene sceneOf(hbMode mode, int size = 24) {
  hbScene scene;
  scene.mode = mode;
  scene.width = scene.height = size;
  return scene;
}

/// Looking along +z at the middle of the unit cube; the picture is `height` high in the world.
hbCamera alongZ(double height) {
  hbCamera camera;
  camera.projection = hbCamera::Projection::orthographic;
  camera.position = {0.5, 0.5, -3.0};
  camera.target = {0.5, 0.5, 0.5};
  camera.up = {0.0, 1.0, 0.0};
  camera.height = height;
  return camera;
}

/// What a pixel's ray spends in the volume, in world length, from the geometry alone.
struct InVolume {
  double length = 0.0;
  glm::dvec3 middle{0.0}; ///< World.
};
InVolume inVolume(const hbGeometry& g, const hbScene& scene, int x, int y) {
  const hbRay ray = scene.cameraFor(g).ray(x + 0.5, y + 0.5, scene.width, scene.height);
  const glm::dmat4 toCube = glm::inverse(g.cubeToWorld());
  const glm::dvec3 o(toCube * glm::dvec4(ray.origin, 1)), v(toCube * glm::dvec4(ray.direction, 0));
  double enter = 0.0, leave = 1e300;
  for (int d = 0; d < 3; ++d) {
    enter = std::max(enter, std::min(-o[d] / v[d], (1 - o[d]) / v[d]));
    leave = std::min(leave, std::max(-o[d] / v[d], (1 - o[d]) / v[d]));
  }
  if (!(leave > enter)) return {};
  return {leave - enter, ray.origin + 0.5 * (enter + leave) * ray.direction};
}

const std::vector<float>& channel(const hbPicture& picture, const std::string& name) { return *picture.find(name); }

} // namespace

// The midpoint rule is exact for constants and for fields linear along the ray, whatever the step. What is left is
// rounding to 32 bits: of the coordinates (2^-25 of the cube, times the slope) and values (5 operations), and of the
// result.
TEST(hbRaycaster, XrayOfConstantAndLinearFieldsIsExact) {
  const hbGeometry g = obliqueGeometry();
  const glm::dvec3 slope(2.0, -3.0, 1.5); // per cube edge
  for (const double steep : {0.0, 1.0})
    for (const auto projection : {hbCamera::Projection::orthographic, hbCamera::Projection::perspective})
      for (const int samples : {1, 3, 50}) {
        std::vector<float> nodes;
        for (int k = 0; k < 2; ++k)
          for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) nodes.push_back(float(7.0 + steep * glm::dot(slope, glm::dvec3(i, j, k))));
        hbGeometry two = g;
        two.size = {2, 2, 2};
        two.spacing = g.extent();
        const hbVolumeField field(hbVolume::fromSamples(two, nodes));
        hbScene scene = sceneOf(hbMode::xray);
        scene.sampling.samples = samples;
        scene.camera = hbCamera::framing(two, 40.0, 25.0, projection);
        const hbPicture picture = hbRaycaster(field, scene).render();
        const glm::dmat4 toCube = glm::inverse(two.cubeToWorld());
        int covered = 0;
        for (int y = 0; y < scene.height; ++y)
          for (int x = 0; x < scene.width; ++x) {
            const InVolume in = inVolume(two, scene, x, y);
            const std::size_t at = std::size_t(x + scene.width * y);
            ASSERT_EQ(channel(picture, "A")[at], in.length > 0 ? 1.0F : 0.0F);
            const double mean = 7.0 + steep * glm::dot(slope, glm::dvec3(toCube * glm::dvec4(in.middle, 1)));
            const double tolerance =
                in.length * (6.0 * 0x1p-24 * 14.0 + steep * 6.5 * 0x1p-25) + 0x1p-24 * in.length * 14.0;
            ASSERT_NEAR(channel(picture, "Y")[at], in.length * mean, tolerance);
            covered += in.length > 0 ? 1 : 0;
          }
        EXPECT_GT(covered, 100);
      }
}

TEST(hbRaycaster, XrayHonoursTheValueMap) {
  // Values around 1e9 that a float could not tell apart; the integral is in true values.
  const hbVolume volume = hbVolume::fromSamples<double>(unitGeometry(2), std::vector<double>(8, 1e9 + 0.25));
  const hbVolumeField field(volume);
  hbScene scene = sceneOf(hbMode::xray, 4);
  scene.camera = alongZ(0.5);
  EXPECT_NE(field.valueMap().offset, 0.0);
  const hbPicture picture = hbRaycaster(field, scene).render();
  for (const float y : channel(picture, "Y")) EXPECT_EQ(y, float(1e9 + 0.25));
}

// Linear along the view: the greatest sample is the midpoint of the last step, half a step before the face.
TEST(hbRaycaster, MipIsTheGreatestSample) {
  const FunctionField field(unitGeometry(9), [](const glm::dvec3& p) { return 10.0 * p.z + p.x; });
  for (const int samples : {1, 7, 300}) { // 300: more than one batch
    hbScene scene = sceneOf(hbMode::mip, 8);
    scene.camera = alongZ(0.5);
    scene.sampling.samples = samples;
    const hbPicture picture = hbRaycaster(field, scene).render();
    for (int x = 0; x < 8; ++x) {
      const InVolume in = inVolume(field.geometry(), scene, x, 3);
      EXPECT_NEAR(channel(picture, "Y")[std::size_t(x + 8 * 3)], 10.0 * (1.0 - 0.5 / samples) + in.middle.x,
                  12.0 * 0x1p-23);
    }
  }
}

TEST(hbRaycaster, MipFindsAKnownMaximum) {
  // The orbital's greatest value is at X = Y = 0, Z = +-6 (derivative of Z^2 exp(-Z/3)): (72 e^-2)^2. A ray along the
  // axis misses it by at most half a step, 1/512 of the cube or 48/512 Bohr; there, with f = (2 Z^2 e^(-Z/3))^2, f'' =
  // -2/9 f at the maximum; the pixels beside the axis are as far.
  const auto field = hbAnalyticField::create("hydrogen");
  hbScene scene = sceneOf(hbMode::mip, 256);
  scene.camera = alongZ(0.5);
  scene.sampling.samples = 256;
  const hbPicture picture = hbRaycaster(*field, scene).render();
  const double greatest = std::pow(72.0 * std::exp(-2.0), 2);
  float found = 0.0F;
  for (const float y : channel(picture, "Y")) found = std::max(found, y);
  EXPECT_LE(found, greatest * (1.0 + 0x1p-23));
  EXPECT_GE(found, greatest * (1.0 - 2.0 * 0.5 * (2.0 / 9.0) * std::pow(48.0 / 512.0, 2)));
}

// The signed distance from a sphere is known everywhere: depth, normal, value and shade of each pixel follow.
TEST(hbRaycaster, IsoFindsASphereWhereItIs) {
  const glm::dvec3 centre(0.5);
  constexpr double kRadius = 0.3;
  const FunctionField field(unitGeometry(65), [&](const glm::dvec3& p) { return kRadius - glm::distance(p, centre); });
  for (const auto projection : {hbCamera::Projection::orthographic, hbCamera::Projection::perspective}) {
    hbScene scene = sceneOf(hbMode::iso, 48);
    scene.isoValue = 0.0;
    scene.camera = hbCamera::framing(field.geometry(), 25.0, 35.0, projection);
    const hbCamera camera = *scene.camera;
    const double step = scene.sampling.stepLength(field.geometry(), camera);
    const hbPicture picture = hbRaycaster(field, scene).render();
    int hits = 0;
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const hbRay ray = camera.ray(x + 0.5, y + 0.5, scene.width, scene.height);
        const double along = glm::dot(centre - ray.origin, ray.direction);
        const double off = glm::length(ray.origin + along * ray.direction - centre);
        const std::size_t at = std::size_t(x + scene.width * y);
        // A chord shorter than a step may be missed.
        if (off < kRadius && 2.0 * std::sqrt(kRadius * kRadius - off * off) < step) continue;
        ASSERT_EQ(channel(picture, "A")[at], off < kRadius ? 1.0F : 0.0F);
        if (off >= kRadius) {
          ASSERT_EQ(channel(picture, "Z")[at], std::numeric_limits<float>::infinity());
          continue;
        }
        ++hits;
        const double distance = along - std::sqrt(kRadius * kRadius - off * off);
        const double cosine = glm::dot(ray.direction, camera.viewAxis());
        // The bracket's width bounds the depth; where the ray grazes, the value's rounding (2^-24 of the cube's
        // coordinates and of the result) moves the crossing by that over the slope, which is half the chord over the
        // radius.
        const double slope = std::sqrt(kRadius * kRadius - off * off) / kRadius;
        const double tolerance = step * hbRaycaster::kIsoBracket + 4.0 * 0x1p-24 / slope + 4.0 * 0x1p-24 * distance;
        ASSERT_NEAR(channel(picture, "Z")[at], distance * cosine, tolerance);
        ASSERT_NEAR(channel(picture, "value")[at], 0.0, tolerance);
        const glm::dvec3 place = ray.origin + distance * ray.direction, normal = glm::normalize(place - centre);
        // Central differences err by h^2/6 times the third derivative, at most 3/R^2, in each axis; the depth's error
        // turns the normal by itself over the radius.
        const double h = 1.0 / 64.0, turned = std::sqrt(3.0) * h * h / 6.0 * 3.0 / ((kRadius - h) * (kRadius - h)) +
                                              tolerance / kRadius + 64.0 * 0x1p-23;
        ASSERT_NEAR(channel(picture, "N.X")[at], normal.x, turned);
        ASSERT_NEAR(channel(picture, "N.Y")[at], normal.y, turned);
        ASSERT_NEAR(channel(picture, "N.Z")[at], normal.z, turned);
        ASSERT_NEAR(channel(picture, "Y")[at], -glm::dot(normal, ray.direction), turned);
      }
    EXPECT_GT(hits, 150);
  }
}

TEST(hbRaycaster, IsoNormalsFollowTheWorldNotTheCube) {
  // The plane x + y = 1 of the cube, whose box is 4 x 2 in the world: its normal is (1/4, 1/2) normalised, not (1, 1).
  hbGeometry g = obliqueGeometry();
  const FunctionField field(g, [](const glm::dvec3& p) { return p.x + p.y; });
  hbScene scene = sceneOf(hbMode::iso, 16);
  scene.isoValue = 1.0;
  scene.camera = hbCamera::framing(g, 10.0, 10.0);
  const hbPicture picture = hbRaycaster(field, scene).render();
  const glm::dvec3 normal = glm::normalize(g.direction * (glm::dvec3(1, 1, 0) / g.extent()));
  int hits = 0;
  for (std::size_t i = 0; i < channel(picture, "A").size(); ++i) {
    if (channel(picture, "A")[i] == 0.0F) continue;
    ++hits;
    const glm::dvec3 found(channel(picture, "N.X")[i], channel(picture, "N.Y")[i], channel(picture, "N.Z")[i]);
    // A linear field's differences are exact but for rounding: 2^-24 of values up to 2 over the shorter difference,
    // 1/16.
    EXPECT_NEAR(std::abs(glm::dot(found, normal)), 1.0, 16.0 * 0x1p-24);
  }
  EXPECT_GT(hits, 20);
}

TEST(hbRaycaster, AValueEqualToTheIsoValueCountsAsAbove) {
  // Steps of 1/8 hit nodes exactly: 0 0 1 0 0 with the iso-value 1 is crossed upwards, and found at the node itself.
  const FunctionField field(unitGeometry(9), [](const glm::dvec3& p) { return p.z == 0.5 ? 1.0 : 0.0; });
  hbScene scene = sceneOf(hbMode::iso, 2);
  scene.camera = alongZ(0.5);
  scene.isoValue = 1.0;
  const hbPicture hit = hbRaycaster(field, scene).render();
  EXPECT_EQ(channel(hit, "A")[0], 1.0F);
  EXPECT_NEAR(channel(hit, "Z")[0], 3.5, 0.125 * hbRaycaster::kIsoBracket);
  scene.isoValue = std::nextafter(1.0F, 2.0F);
  EXPECT_EQ(channel(hbRaycaster(field, scene).render(), "A")[0], 0.0F);
}

TEST(hbRaycaster, ACameraInsideSeesWhatLiesBeforeIt) {
  const FunctionField field(unitGeometry(9), [](const glm::dvec3&) { return 2.0; });
  hbScene scene = sceneOf(hbMode::xray, 9);
  hbCamera camera;
  camera.position = {0.5, 0.25, 0.5};
  camera.target = {0.5, 1.0, 0.5};
  scene.camera = camera;
  const hbPicture picture = hbRaycaster(field, scene).render();
  // The middle pixel looks along +y: 0.75 of the cube lies before it, none of what is behind counts.
  EXPECT_NEAR(channel(picture, "Y")[std::size_t(4 + 9 * 4)], 1.5, 1.5 * 0x1p-23);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x)
      EXPECT_NEAR(channel(picture, "Y")[std::size_t(x + 9 * y)], 2.0 * inVolume(field.geometry(), scene, x, y).length,
                  4.0 * 0x1p-24);
}

TEST(hbRaycaster, PlanesAcrossAParallelViewAreTheEquidistantSamples) {
  // Along an axis both kinds take the same samples: rounding alone remains, a few ulp of coordinates on a field of
  // slope 7.
  const FunctionField field(unitGeometry(17), [](const glm::dvec3& p) { return std::sin(7.0 * p.z) + p.x; });
  for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
    hbScene scene = sceneOf(mode, 8);
    scene.camera = alongZ(0.9);
    scene.sampling.samples = 40;
    const hbPicture equidistant = hbRaycaster(field, scene).render();
    scene.sampling.kind = hbSampling::Kind::planewise;
    const hbPicture planewise = hbRaycaster(field, scene).render();
    for (std::size_t i = 0; i < 64; ++i)
      EXPECT_NEAR(channel(planewise, "Y")[i], channel(equidistant, "Y")[i], 8.0 * 0x1p-22);
  }
}

TEST(hbRaycaster, PlanewiseWeightsAreTheSpacingOverTheCosine) {
  // A constant: the sum is the number of planes met inside times step/cos, which errs by at most one plane.
  const FunctionField field(obliqueGeometry(), [](const glm::dvec3&) { return 1.0; });
  for (const auto projection : {hbCamera::Projection::orthographic, hbCamera::Projection::perspective}) {
    hbScene scene = sceneOf(hbMode::xray, 16);
    scene.camera = hbCamera::framing(field.geometry(), 40.0, 25.0, projection);
    scene.sampling = {hbSampling::Kind::planewise, 64};
    const double step = scene.sampling.stepLength(field.geometry(), *scene.camera);
    const hbPicture picture = hbRaycaster(field, scene).render();
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        const double cosine = glm::dot(scene.camera->ray(x + 0.5, y + 0.5, 16, 16).direction, scene.camera->viewAxis());
        const double sum = channel(picture, "Y")[std::size_t(x + 16 * y)], planes = sum / (step / cosine);
        EXPECT_NEAR(planes, std::round(planes), 64.0 * 0x1p-23); // at most 64, stored as a float
        EXPECT_NEAR(sum, inVolume(field.geometry(), scene, x, y).length, step / cosine + sum * 0x1p-23);
      }
  }
}

TEST(hbRaycaster, PlanewiseIsoInterpolatesBetweenThePlanes) {
  // z^2 = 0.3 between the planes at 0.45 and 0.55: linear interpolation gives 0.45 + 0.1 (0.3 - 0.2025) / (0.3025 -
  // 0.2025).
  const FunctionField field(unitGeometry(9), [](const glm::dvec3& p) { return p.z * p.z; });
  hbScene scene = sceneOf(hbMode::iso, 2);
  scene.camera = alongZ(0.5);
  scene.sampling = {hbSampling::Kind::planewise, 10};
  scene.isoValue = 0.3;
  EXPECT_NEAR(
      channel(hbRaycaster(field, scene).render(), "Z")[0], 3.0 + 0.45 + 0.1 * 0.975,
      8.0 * 0x1p-23); // the field rises by 1 a unit here: a few roundings of values below 1, one of a depth below 4
}

// In X-rays of 1, lengths are what is left of rays; on planes, as many as are left.
TEST(hbRaycaster, AClipBoxIsWhatIsSeen) {
  const hbGeometry g = obliqueGeometry();
  const FunctionField field(g, [](const glm::dvec3&) { return 1.0; });
  hbScene scene = sceneOf(hbMode::xray);
  scene.clip = {{0.0, 0.25, 0.1}, {1.0, 0.75, 0.6}};
  scene.sampling.samples = 400;
  const glm::dmat4 toCube = glm::inverse(g.cubeToWorld());
  for (const auto kind : {hbSampling::Kind::equidistant, hbSampling::Kind::planewise}) {
    scene.sampling.kind = kind;
    const hbPicture picture = hbRaycaster(field, scene).render();
    const double step = scene.sampling.stepLength(g, scene.cameraFor(g));
    int seen = 0;
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const hbRay ray = scene.cameraFor(g).ray(x + 0.5, y + 0.5, scene.width, scene.height);
        const auto in = hb::clipToCube(ray, toCube, scene.clip->lo, scene.clip->hi);
        if (in)
          for (int d = 0; d < 3; ++d) { // its ends lie in the box
            EXPECT_NEAR(in->at(in->enter)[d], std::clamp(in->at(in->enter)[d], scene.clip->lo[d], scene.clip->hi[d]),
                        1e-9);
            EXPECT_NEAR(in->at(in->leave)[d], std::clamp(in->at(in->leave)[d], scene.clip->lo[d], scene.clip->hi[d]),
                        1e-9);
          }
        const double length = in ? in->length() : 0.0;
        // Planes: one more or less, at an angle of up to 45 degrees to the view axis.
        const double tolerance = kind == hbSampling::Kind::planewise ? 1.5 * step : 1e-6 * length;
        EXPECT_NEAR(channel(picture, "Y")[std::size_t(x + scene.width * y)], length, tolerance) << x << " " << y;
        seen += length > 0.0;
      }
    EXPECT_GT(seen, 50);
    hbScene whole = scene;
    whole.clip.reset();
    EXPECT_GT(std::ranges::count(channel(hbRaycaster(field, whole).render(), "A"), 1.0F), seen);
  }
}

TEST(hbRaycaster, ASliceIsTheFieldOnItsPlane) {
  const hbGeometry g = obliqueGeometry();
  const FunctionField field(g, [](const glm::dvec3& p) { return 1.0 + p.x + 2.0 * p.y + 4.0 * p.z; });
  hbScene scene = sceneOf(hbMode::slice);
  const glm::dmat4 world = g.cubeToWorld();
  scene.slice = {glm::dvec3(world * glm::dvec4(0.5, 0.5, 0.5, 1.0)), {1.0, -2.0, 0.5}};
  const hbPicture picture = hbRaycaster(field, scene).render();
  int seen = 0;
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) {
      const hbRay ray = scene.cameraFor(g).ray(x + 0.5, y + 0.5, scene.width, scene.height);
      const double way =
          glm::dot(scene.slice->point - ray.origin, scene.slice->normal) / glm::dot(ray.direction, scene.slice->normal);
      const glm::dvec3 p(glm::inverse(world) * glm::dvec4(ray.origin + way * ray.direction, 1.0));
      const bool isIn = way > 0.0 && p == glm::clamp(p, 0.0, 1.0);
      const std::size_t i = std::size_t(x + scene.width * y);
      EXPECT_EQ(channel(picture, "A")[i], isIn ? 1.0F : 0.0F) << x << " " << y;
      // Coordinates and the value are rounded to floats: 7 2^-25 and 8 2^-24.
      EXPECT_NEAR(channel(picture, "Y")[i], isIn ? 1.0 + p.x + 2.0 * p.y + 4.0 * p.z : 0.0, 1e-6) << x << " " << y;
      seen += isIn;
    }
  EXPECT_GT(seen, 50);
  scene.slice->normal = scene.cameraFor(g).viewAxis();
  scene.slice->point = scene.cameraFor(g).position; // behind everything
  const hbPicture nothing = hbRaycaster(field, scene).render();
  for (const float a : channel(nothing, "A")) EXPECT_EQ(a, 0.0F);
}

// Wherever a volume lies: its faces are part of it, however world and cube coordinates are rounded.
TEST(hbRaycaster, ASliceAtAFaceIsTheFace) {
  for (const double origin : {0.0, -0.35, 12.7, -90.3})
    for (const double spacing : {0.7, 1.1, 0.4883})
      for (int axis = 0; axis < 3; ++axis)
        for (const double end : {0.0, 1.0}) {
          hbGeometry g;
          g.size = {5, 4, 7};
          g.spacing = glm::dvec3(spacing);
          g.origin = glm::dvec3(origin);
          const FunctionField field(g, [](const glm::dvec3&) { return 1.0; });
          hbScene scene = sceneOf(hbMode::slice, 8);
          glm::dvec3 at(0.5), normal(0.0);
          at[axis] = end;
          normal[axis] = 1.0;
          scene.slice = {glm::dvec3(g.cubeToWorld() * glm::dvec4(at, 1.0)), normal};
          hbCamera camera;
          camera.projection = hbCamera::Projection::orthographic;
          camera.target = scene.slice->point;
          camera.position = camera.target + 9.0 * normal;
          camera.up = glm::dvec3(normal.y, normal.z, normal.x);
          camera.height = spacing; // within the face
          scene.camera = camera;
          const hbPicture picture = hbRaycaster(field, scene).render();
          for (const float a : channel(picture, "A")) EXPECT_EQ(a, 1.0F) << origin << " " << spacing << " " << axis;
        }
}

TEST(hbRaycaster, EveryEngineGivesTheSamePictures) {
  for (const hbIndexSet& set :
       {hbIndexSet::regular(5, {}), hbIndexSet::anisotropic({5, 2, 4}, {}), hbTestSets::uneven()}) {
    const hbSparseGrid grid =
        hbSparseGrid::interpolate(*hbAnalyticField::create("vortex,size=33"), set, hbLatticeMapping::fitted);
    const hbCombinationSparseGrid combination(grid);
    double largest = 0.0;
    for (const double v : grid.nodalValues(0)) largest = std::max(largest, std::abs(v));
    const hbSemiNodalGrid semiNodal(grid);
    const double direct = hb::directBound(grid);
    const std::array<std::pair<const hbField*, double>, 2> others{
        {{&combination, direct + hb::combinationBound(set, largest)}, {&semiNodal, direct + hb::semiNodalBound(grid)}}};
    for (const auto& [other, bound] : others)
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        const hbScene scene = sceneOf(mode, 32);
        const hbPicture a = hbRaycaster(grid, scene).render(), b = hbRaycaster(*other, scene).render();
        const double longest = mode == hbMode::xray ? std::sqrt(3.0) : 1.0;
        for (std::size_t i = 0; i < channel(a, "Y").size(); ++i)
          ASSERT_NEAR(channel(a, "Y")[i], channel(b, "Y")[i], bound * longest);
      }
  }
}

TEST(hbRaycaster, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const hbSparseGrid grid = hbSparseGrid::interpolate(*hbAnalyticField::create("hydrogen,size=17"),
                                                      hbIndexSet::regular(4, {}), hbLatticeMapping::fitted);
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
    hbScene scene = sceneOf(mode, 40); // not a multiple of the tiles
    scene.isoValue = 10.0;
    std::map<std::string, std::vector<float>> first;
    for (const std::size_t threads : {1U, 2U, 7U}) {
      const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
      const hbPicture picture = hbRaycaster(grid, scene).render();
      if (first.empty()) first = picture.channels;
      EXPECT_EQ(picture.channels, first) << threads;
    }
  }
}

TEST(hbRaycaster, KeepsTheSceneWithItsCamera) {
  const auto field = hbAnalyticField::create("smooth,size=5");
  const hbPicture picture = hbRaycaster(*field, sceneOf(hbMode::xray, 4)).render();
  const hbScene kept = hb::sceneFromJson(picture.metadata.at(hbPicture::kSceneKey), "test");
  ASSERT_TRUE(kept.camera);
  EXPECT_EQ(*kept.camera, hbCamera::framing(field->geometry()));
}

TEST(hbRaycaster, RefusesWhatItCannotDraw) {
  const auto field = hbAnalyticField::create("smooth,size=5");
  EXPECT_THROW(hbRaycaster(*field, sceneOf(hbMode::iso)), hbError);   // no iso-value
  EXPECT_THROW(hbRaycaster(*field, sceneOf(hbMode::slice)), hbError); // no plane
  hbScene scene = sceneOf(hbMode::xray);
  scene.component = 1;
  EXPECT_THROW(hbRaycaster(*field, scene), hbError);
  scene = sceneOf(hbMode::xray, 0);
  EXPECT_THROW(hbRaycaster(*field, scene), hbError);
}

TEST(hbRaycaster, StopsWhenCancelled) {
  const auto field = hbAnalyticField::create("smooth,size=5");
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hbRaycaster(*field, sceneOf(hbMode::xray)).render(progress), hbCancelled);
}
