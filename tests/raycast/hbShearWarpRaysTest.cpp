// Shear-warp beside ray casting.

#include <gtest/gtest.h>

#include "raycast/hbRaycaster.h"
#include "raycast/hbShearReference.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbTestScenes.h"

using namespace hbTestScenes;

namespace {

/// Up along another axis than framing() takes: the picture's columns are the lattice's rows.
hbCamera turned(hbCamera camera) {
  camera.up = glm::cross(camera.viewAxis(), camera.up);
  return camera;
}

} // namespace

// Along an axis the warp changes nothing, and slices are the planes of planewise ray casting.
TEST(hbShearWarp, AlongAnAxisItIsPlanewiseRayCasting) {
  int compared = 0;
  hbGeometry g = box({9, 17, 9}, {2.0, 3.0, 1.5});
  g.direction[0] = -g.direction[0]; // mirrored
  const hbSparseGrid grid = gridOf(g, 4, {waves});
  for (const Projection projection : {Projection::orthographic, Projection::perspective})
    for (const auto& [azimuth, elevation] :
         {std::pair(0.0, 0.0), {90.0, 0.0}, {180.0, 0.0}, {270.0, 0.0}, {0.0, 90.0}, {0.0, -90.0}})
      for (const bool isTurned : {false, true})
        for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
          hbCamera camera = hbCamera::framing(g, azimuth, elevation, projection);
          if (isTurned) camera = turned(camera);
          hbScene scene = sceneOf(mode, camera, 15, 13, 20);
          scene.sampling.kind = hbSampling::Kind::planewise;
          const hbShearReference reference(grid, scene);
          const hbPicture warped = draw(grid, scene), cast = hbRaycaster(grid, scene).render();
          // Values of either engine, and the rounding of the caster's coordinates to floats.
          const double rounding =
              reference.rounding() + hb::directBound(grid) + glm::dot(reference.slopes(), glm::dvec3(0x1p-24));
          for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
              const std::size_t at = std::size_t(x + scene.width * y);
              const auto in = inCube(g, reference.scene(), x, y);
              const double found = channel(warped, "Y")[at], expected = channel(cast, "Y")[at];
              if (mode == hbMode::iso) {
                // Where a value is the iso-value but for rounding, one of them may see a crossing and the other not.
                if (channel(warped, "A")[at] != channel(cast, "A")[at]) ADD_FAILURE() << x << " " << y;
                continue;
              }
              // Rays that leave through a side between two planes have none.
              if (!in || channel(cast, "A")[at] == 0.0F) continue;
              if (mode == hbMode::mip) {
                ASSERT_NEAR(found, expected, rounding + 0x1p-23 * std::abs(expected));
                continue;
              }
              // A perspective ray through a side ends between planes; the length counts that, planes do not.
              const glm::dvec3 depth = glm::abs(in->leave - in->enter);
              if (std::max({depth.x, depth.y, depth.z}) < 1.0 - 1e-12) continue;
              ++compared;
              ASSERT_NEAR(found, expected, in->length * rounding + 0x1p-22 * std::abs(expected)) << x << " " << y;
            }
        }
  EXPECT_GT(compared, 1500);
}

// What a pixel shows comes from rays beside its own, and from slices instead of steps: no point that either looks at is
// farther from one of the other's than these distances, which the field's slopes turn into a bound of the difference.
TEST(hbShearWarp, IsWithinADerivedBoundOfRayCasting) {
  for (const hbGeometry& g : {box({17, 17, 17}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 4, {waves});
    int covered = 0;
    for (const hbCamera& camera : cameras(g))
      for (const auto& [mode, clip] :
           {std::pair(hbMode::xray, 0), {hbMode::mip, 0}, {hbMode::xray, 1}, {hbMode::mip, 1}, {hbMode::xray, 2}}) {
        hbScene scene = sceneOf(mode, camera, 20, 16, 24);
        scene.clip = clipBoxes()[std::size_t(clip)];
        hbShearReference reference(grid, scene);
        const hbPicture warped = draw(grid, scene), cast = hbRaycaster(grid, scene).render();
        const glm::dvec3 slopes = reference.slopes();
        const auto change = [&](const glm::dvec3& way) { return glm::dot(slopes, glm::abs(way)); };
        const double rounding = reference.rounding() + hb::directBound(grid) + change(glm::dvec3(0x1p-24));
        const double step = scene.sampling.stepLength(g, camera);
        for (int y = 0; y < scene.height; ++y)
          for (int x = 0; x < scene.width; ++x) {
            const std::size_t at = std::size_t(x + scene.width * y);
            const auto in = inCube(g, scene, x, y);
            ASSERT_EQ(channel(warped, "A")[at], channel(cast, "A")[at]);
            if (!in) continue;
            ++covered;
            // Of the field along the pixel's ray, and on one around it: the greatest distance between points at the
            // same share of both is that of the beginnings or of the ends.
            const glm::dvec3 whole = in->leave - in->enter, oneStep = whole / std::ceil(in->length / step);
            double beside = 0.0, slab = 0.0;
            bool isAlone = true;
            for (const auto& n : reference.neighbours(x + 0.5, y + 0.5)) {
              const hbShearReference::Samples& s = reference.samples(*n.rays, n.i, n.j);
              if (s.values.empty()) continue;
              isAlone = false;
              const int last = s.first + int(s.values.size()) - 1;
              const glm::dvec3 first = hbShearReference::point(*n.rays, n.i, n.j, s.first),
                               far = hbShearReference::point(*n.rays, n.i, n.j, last),
                               way = reference.slabOf(*n.rays, n.i, n.j, s.first);
              beside = std::max(
                  {beside, change(in->enter - (first - s.before * way)), change(in->leave - (far + s.after * way))});
              slab = std::max(slab, change(way));
            }
            // The midpoint rule misses a mean by a quarter of the change in a step. A slab at an end reaches up to a
            // whole one beyond its slice, on average half of it (if that end is the other, too). A maximum is missed by
            // half a step, or a whole slab at an end; one value in the middle likewise.
            const bool isMean = mode == hbMode::xray;
            const double ofSlab = isMean ? 0.5 : 1.0, ofStep = isMean ? 0.25 : 0.5;
            if (isAlone) slab = change(whole);
            const double bound = beside + ofSlab * slab + ofStep * change(oneStep) + rounding;
            const double length = mode == hbMode::xray ? in->length : 1.0;
            const double expected = channel(cast, "Y")[at];
            ASSERT_NEAR(channel(warped, "Y")[at], expected, length * bound + 0x1p-22 * std::abs(expected))
                << x << " " << y;
          }
      }
    EXPECT_GT(covered, 20 * 16 * 10);
  }
}

// Seen from an angle about the view axis the warp interpolates between rays h apart, with at most h^2/8 times the
// second derivative along either axis. The field is quadratic there: its interpolant at level n is off by 4^-n/8 times
// the same, and the sum over the depth is exact.
TEST(hbShearWarp, SupersamplingTakesTheWarpsErrorDown) {
  constexpr int kLevel = 8;
  constexpr double kSecond = 6.0; // derivative along x and along y
  const auto f = [](const glm::dvec3& p) { return 0.5 * kSecond * (p.x * p.x + p.y * p.y) - p.z; };
  const auto axis = [&](std::int64_t n) { return std::int64_t{1} << n; };
  // A sum of functions of one axis each is in the regular set as it is in the full one.
  hbGeometry g = box({axis(kLevel) + 1, axis(kLevel) + 1, 2}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, kLevel, {f});
  hbCamera camera = hbCamera::framing(g, 0.0, 90.0, Projection::orthographic);
  const double angle = 0.4;
  camera.up = {std::sin(angle), std::cos(angle), 0.0};
  camera.height = 0.6; // inside the box all around
  std::map<int, double> errors;
  for (const int supersample : {1, 2, 4, 8}) {
    const hbScene scene = sceneOf(hbMode::xray, camera, 20, 20, 4);
    const hbPicture picture = draw(grid, scene, supersample);
    const double h = camera.height / scene.height / supersample;
    const double bound = 2.0 * kSecond / 8.0 * (h * h + std::pow(4.0, -kLevel));
    const double rounding = hbShearReference(grid, scene).rounding();
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const auto in = inCube(g, scene, x, y);
        ASSERT_TRUE(in);
        const double expected = f(0.5 * (in->enter + in->leave)); // times a length of 1
        const double error = std::abs(channel(picture, "Y")[std::size_t(x + 20 * y)] - expected);
        ASSERT_LE(error, bound + rounding + 0x1p-22 * std::abs(expected));
        errors[supersample] = std::max(errors[supersample], error);
      }
  }
  // Neither bound is idle: some pixel comes near to it.
  EXPECT_GT(errors[1], 4.0 * errors[4]);
  EXPECT_GT(errors[2], 4.0 * errors[8]);
}
