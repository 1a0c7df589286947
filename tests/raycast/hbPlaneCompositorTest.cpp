#include "raycast/hbPlaneCompositor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "raycast/hbRaycaster.h"
#include "raycast/hbShearReference.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbDvrBounds.h"
#include "tests/raycast/hbDvrScenes.h"
#include "tests/raycast/hbLitBounds.h"
#include "tests/raycast/hbTestScenes.h"
#include "volume/hbError.h"

using namespace hbTestScenes;

namespace {

/// Hands the planes over, evaluated point by point.
hbPicture composited(const hbField& field, const hbScene& scene) {
  const hbPlaneRays rays(field, scene);
  hbPlaneCompositor planes(rays);
  std::vector<float> x, y, z, values(std::size_t(scene.width * scene.height));
  for (int i = 0; i < rays.planes(); ++i) {
    const hbPlaneRays::Plane plane = rays.plane(i);
    x.clear();
    y.clear();
    z.clear();
    for (int py = 0; py < scene.height; ++py)
      for (int px = 0; px < scene.width; ++px) {
        const glm::dvec3 p = plane.corner + (px + 0.5) * plane.right + (py + 0.5) * plane.down;
        x.push_back(float(p.x));
        y.push_back(float(p.y));
        z.push_back(float(p.z));
      }
    field.values({x, y, z}, scene.component, values);
    planes.add(i, values);
  }
  return planes.finish();
}

hbScene planewise(hbMode mode, const hbCamera& camera) {
  hbScene scene = sceneOf(mode, camera, 19, 13);
  scene.sampling.kind = hbSampling::Kind::planewise;
  return scene;
}

void expectNear(const hbPicture& found, const hbPicture& expected, const hbPlaneRays& rays, double perValue, int& seen,
                int& opaque) {
  const hbDvrBounds bounds(rays);
  const std::vector<float> opacities = channel(expected, "A");
  for (std::size_t i = 0; i < opacities.size(); ++i) {
    // Shown in floats, of which a luminance is a sum.
    const double moved = bounds.channel(i, perValue) + 0x1p-22;
    const double tolerance = moved + hbDvrBounds::ends(opacities[i], channel(found, "A")[i], moved);
    for (const char* name : {"R", "G", "B", "A", "Y"})
      EXPECT_NEAR(channel(found, name)[i], channel(expected, name)[i], tolerance) << name << i;
    seen += opacities[i] > 0.0F;
    opaque += opacities[i] > 1.0 - hbEmissionAbsorption::kOpaque;
  }
}

} // namespace

// The two find the same points but for rounding to floats, by 2^-24 a coordinate and half of that again.
TEST(hbPlaneCompositor, XrayAndMipArePlanewiseRayCasting) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        const hbScene scene = planewise(mode, camera);
        hbShearReference reference(grid, scene, 1);
        const hbPicture expected = hbRaycaster(grid, scene).render(), found = composited(grid, scene);
        EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
        const std::vector<float> ys = channel(found, "Y"), exact = channel(expected, "Y");
        const double perValue = glm::dot(reference.slopes(), glm::dvec3(3 * 0x1p-24));
        // An X-ray is a sum of values times at most its length in the volume and a slab.
        const double longest = glm::length(g.extent()) + scene.sampling.stepLength(g, camera) * 16.0;
        for (std::size_t i = 0; i < ys.size(); ++i)
          EXPECT_NEAR(ys[i], exact[i], perValue * (mode == hbMode::xray ? longest : 1.0) + 0x1p-22 * std::abs(exact[i]))
              << i;
      }
  }
}

// Of a linear field, whose difference between two planes is known along every ray.
TEST(hbPlaneCompositor, IsoSurfacesLieWherePlanewiseRayCastingFindsThem) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 1, {[](const glm::dvec3& p) { return p.x + 2.0 * p.y + 3.0 * p.z - 2.7; }});
  const glm::dvec3 slopes(1.0, 2.0, 3.0);
  const double perSlope = 4.0 * hb::directBound(grid) * glm::length(1.0 / (g.cubeSpacing() * g.extent()));
  EXPECT_LT(perSlope, 1e-4);
  int surfaces = 0;
  for (const hbCamera& camera : cameras(g)) {
    const hbScene scene = planewise(hbMode::iso, camera);
    const hbPicture expected = hbRaycaster(grid, scene).render(), found = composited(grid, scene);
    EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
    const double step = scene.sampling.stepLength(g, camera);
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const auto i = std::size_t(x + scene.width * y);
        if (channel(expected, "A")[i] == 0.0F) continue;
        ++surfaces;
        const hbRay ray = camera.ray(x + 0.5, y + 0.5, scene.width, scene.height);
        const glm::dvec3 way(glm::inverse(g.cubeToWorld()) * glm::dvec4(ray.direction, 0.0));
        const double change = std::abs(glm::dot(way, slopes)) * step / glm::dot(ray.direction, camera.viewAxis());
        // Three values rounded to floats of up to 8 (of a difference of them, and of what they are evaluated at).
        const double inSteps = 12 * 8 * 0x1p-24 / change;
        const double z = channel(expected, "Z")[i];
        EXPECT_NEAR(channel(found, "Z")[i], z, inSteps * step + 0x1p-22 * std::abs(z)) << x << " " << y;
        EXPECT_NEAR(channel(found, "value")[i], channel(expected, "value")[i], inSteps * change + 12 * 8 * 0x1p-24);
        // Slopes are differences of two values over a sample spacing at the least, so each is off by twice a value's
        // rounding over that, in either picture; lengths are the world's. The gradient there is longer than 2, by which
        // a unit normal moves less; that leaves room for the third axis' shear.
        for (const char* n : {"Y", "N.X", "N.Y", "N.Z"})
          EXPECT_NEAR(channel(found, n)[i], channel(expected, n)[i], perSlope) << n;
      }
  }
  EXPECT_GT(surfaces, 500);
}

// The same samples, lengths and sums, but for the rounding of points and of lengths (in 64 bits) and of what is shown.
TEST(hbPlaneCompositor, DvrIsPlanewiseRayCasting) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    int seen = 0, opaque = 0;
    for (const hbCamera& camera : cameras(g))
      for (const int samples : {2, 9}) { // with two planes, many rays meet none
        hbScene scene = dvrScene(ramp(), camera, samples, hbSampling::Kind::planewise);
        hbShearReference reference(grid, scene, 1);
        const double perValue = glm::dot(reference.slopes(), glm::dvec3(3 * 0x1p-24));
        expectNear(composited(grid, scene), hbRaycaster(grid, scene).render(), hbPlaneRays(grid, scene), perValue, seen,
                   opaque);
      }
    EXPECT_GT(seen, 5000);
    EXPECT_GT(opaque, 20);
  }
}

TEST(hbPlaneCompositor, PreintegratedDvrIsPlanewiseRayCasting) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  const std::vector<hbCamera> all = cameras(g);
  int seen = 0, opaque = 0;
  for (const std::size_t i : {std::size_t{6}, all.size() - 2}) { // oblique, and from within
    hbScene scene = dvrScene(ramp(4.0), all[i], 5, hbSampling::Kind::planewise);
    scene.preintegrated = true;
    hbShearReference reference(grid, scene, 1);
    const double perValue = glm::dot(reference.slopes(), glm::dvec3(3 * 0x1p-24));
    expectNear(composited(grid, scene), hbRaycaster(grid, scene).render(), hbPlaneRays(grid, scene), perValue, seen,
               opaque);
  }
  EXPECT_GT(seen, 200);
}

// Of what is in the box alone, that between two planes included. Box and volume share no face.
TEST(hbPlaneCompositor, ClippedIsPlanewiseRayCasting) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  const std::vector<hbCamera> all = cameras(g);
  int seen = 0, opaque = 0;
  for (const std::size_t i : {std::size_t{6}, all.size() - 2})
    for (const int samples : {2, 9}) {
      hbScene scene = dvrScene(ramp(), all[i], samples, hbSampling::Kind::planewise);
      scene.clip = {{0.2, 0.1, 0.3}, {0.9, 0.7, 0.8}};
      hbShearReference reference(grid, scene, 1);
      const double perValue = glm::dot(reference.slopes(), glm::dvec3(3 * 0x1p-24));
      expectNear(composited(grid, scene), hbRaycaster(grid, scene).render(), hbPlaneRays(grid, scene), perValue, seen,
                 opaque);
    }
  EXPECT_GT(seen, 200);
}

// In 64 bits but for values, of a linear field, whose gradient is known. Some rays meet none of four planes.
TEST(hbPlaneCompositor, LitIsPlanewiseRayCasting) {
  const hbGeometry g = awkward();
  const glm::dvec3 slopes(0.6, 1.0, 0.75);
  const hbSparseGrid grid = gridOf(g, 2, {[&](const glm::dvec3& p) { return glm::dot(slopes, p); }});
  const std::vector<hbCamera> all = cameras(g);
  int seen = 0;
  for (const hbCamera& camera : {all[6], all[18]}) // oblique; by perspective
    for (const bool isPreintegrated : {false, true})
      for (const bool isFaint : {false, true}) {
        hbScene scene = dvrScene(ramp(4.0), camera, 4, hbSampling::Kind::planewise);
        scene.preintegrated = isPreintegrated;
        const hbPicture unlit = hbRaycaster(grid, scene).render();
        scene.shading = placedLight(g, camera, slopes);
        if (isFaint) scene.gradientOpacity = {0.1, 1.1};
        const hbPlaneRays rays(grid, scene);
        const hbLitBounds bounds(rays, slopes);
        const double perValue =
            glm::dot(hbShearReference(grid, scene, 1).slopes(), glm::dvec3(3 * 0x1p-24)) + 2.0 * hb::directBound(grid);
        const hbPicture found = composited(grid, scene), expected = hbRaycaster(grid, scene).render();
        const std::vector<float> opacities = channel(expected, "A");
        for (std::size_t i = 0; i < opacities.size(); ++i) {
          // Places and directions are in 64 bits.
          const double moved = bounds.channel(i, perValue, 2.0 * perValue, 0.0, false) + 0x1p-22;
          EXPECT_LT(moved, 0.01); // below what is counted as seen
          for (const char* name : {"R", "G", "B", "A", "Y"})
            EXPECT_NEAR(channel(found, name)[i], channel(expected, name)[i], moved) << name << i;
          seen += std::abs(double(channel(unlit, "R")[i]) - double(channel(expected, "R")[i])) > 0.01;
          const double whole = channel(unlit, "A")[i];
          if (whole > 0.01) {
            EXPECT_EQ(double(opacities[i]) < 0.95 * whole, isFaint) << i;
          }
        }
      }
  EXPECT_GT(seen, 250);
}

TEST(hbPlaneCompositor, RefusesWhatTheRayCasterDoes) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  hbScene scene = planewise(hbMode::iso, hbCamera::framing(g));
  scene.isoValue.reset();
  EXPECT_THROW(hbPlaneRays(grid, scene), hbError);
  scene.mode = hbMode::xray;
  scene.component = 1;
  EXPECT_THROW(hbPlaneRays(grid, scene), hbError);
  scene.component = 0;
  EXPECT_NO_THROW(hbPlaneRays(grid, scene));
  scene.mode = hbMode::dvr;
  EXPECT_THROW(hbPlaneRays(grid, scene), hbError);
}
