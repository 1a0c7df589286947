#include "scene/hbCamera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbError.h"

namespace {

using Projection = hbCamera::Projection;

hbCamera lookingAlongY(Projection projection) {
  hbCamera camera;
  camera.projection = projection;
  camera.position = {1.0, -10.0, 2.0};
  camera.target = {1.0, 0.0, 2.0};
  camera.fieldOfView = 90.0;
  camera.height = 6.0;
  return camera;
}

double real(double lo, double hi) { return lo + (hi - lo) * double(*rc::gen::inRange(0, 1 << 20)) / (1 << 20); }

/// Sizes 1 (flat) to 400, spacings over five decades, any rotation, sometimes sheared.
hbGeometry anyGeometry() {
  hbGeometry g;
  for (int d = 0; d < 3; ++d) {
    g.size[d] = *rc::gen::element(1, 2, 17, 400);
    g.spacing[d] = std::pow(10.0, real(-3.0, 2.0));
    g.origin[d] = real(-1000.0, 1000.0);
  }
  const glm::dvec3 a(real(-1, 1), real(-1, 1), real(0.1, 1)), b(real(-1, 1), 1.0, real(-1, 0));
  g.direction[0] = glm::normalize(a);
  g.direction[1] = glm::normalize(glm::cross(a, b));
  g.direction[2] = glm::cross(g.direction[0], g.direction[1]);
  if (*rc::gen::arbitrary<bool>()) g.direction[1] = glm::normalize(g.direction[1] + 0.5 * g.direction[0]);
  return g;
}

/// The place of a world point in the picture: (-1..1, -1..1), x right, y up. Projected without ray().
glm::dvec2 projected(const hbCamera& camera, const glm::dvec3& point, double aspect) {
  const glm::dvec3 forward = glm::normalize(camera.target - camera.position);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
  const glm::dvec3 p = point - camera.position;
  const double depth = glm::dot(p, forward);
  const double half = camera.projection == Projection::perspective
                          ? depth * std::tan(glm::radians(camera.fieldOfView) / 2)
                          : camera.height / 2;
  return {glm::dot(p, right) / (half * aspect), glm::dot(p, up) / half};
}

} // namespace

RC_GTEST_PROP(hbCamera, FramingHasEveryCornerJustInView, ()) {
  const hbGeometry g = anyGeometry();
  const double aspect = *rc::gen::element(1.0, 0.5, 16.0 / 9.0, 7.0);
  const auto projection = *rc::gen::element(Projection::perspective, Projection::orthographic);
  const hbCamera camera = hbCamera::framing(g, real(-400, 400), real(-90, 90), projection, aspect);
  const glm::dmat4 world = g.cubeToWorld();
  double outermost = 0.0;
  for (int c = 0; c < 8; ++c) {
    const glm::dvec3 corner(world * glm::dvec4(c & 1, c >> 1 & 1, c >> 2, 1));
    RC_ASSERT(glm::dot(corner - camera.position, camera.viewAxis()) > 0.0);
    const glm::dvec2 p = projected(camera, corner, aspect);
    outermost = std::max({outermost, std::abs(p.x), std::abs(p.y)});
  }
  // The worst rounding is in corner minus position: eps * 1e3 (origin) over the smallest box and margin, 2e-3 * 0.02.
  RC_ASSERT(std::abs(outermost * hbCamera::kFramingMargin - 1.0) < 64 * 0x1p-52 * 1e3 / (2e-3 * 0.02));
}

TEST(hbCamera, FramesFlatAndVeryThinVolumes) {
  for (const hbSize3 size : {hbSize3{512, 512, 1}, hbSize3{1, 1, 1}, hbSize3{1, 300, 1}})
    for (const double elevation : {-90.0, 0.0, 20.0, 90.0})
      for (const auto projection : {Projection::perspective, Projection::orthographic}) {
        hbGeometry g;
        g.size = size;
        g.spacing = {1.0, 1.0, 0.001};
        const hbCamera camera = hbCamera::framing(g, 30.0, elevation, projection, 1.5);
        double outermost = 0.0;
        for (int c = 0; c < 8; ++c) {
          const glm::dvec2 p =
              projected(camera, glm::dvec3(g.cubeToWorld() * glm::dvec4(c & 1, c >> 1 & 1, c >> 2, 1)), 1.5);
          outermost = std::max({outermost, std::abs(p.x), std::abs(p.y)});
        }
        // Coordinates up to 512 beside half edges of 1/2 or more: 1e3 eps, some ten operations.
        EXPECT_NEAR(outermost, 1.0 / hbCamera::kFramingMargin, 1e4 * 0x1p-52);
        EXPECT_GT(outermost, 0.97);
      }
}

TEST(hbCamera, AzimuthTurnsCounterClockwiseSeenFromAbove) {
  hbGeometry g;
  g.size = {3, 3, 3};
  const auto axis = [&](double azimuth, double elevation) {
    return hbCamera::framing(g, azimuth, elevation, Projection::orthographic, 1.0).viewAxis();
  };
  // Sines and cosines of multiples of 90 degrees and one normalisation: a few eps.
  constexpr double kTolerance = 8 * 0x1p-52;
  EXPECT_LT(glm::distance(axis(0, 0), glm::dvec3(0, 1, 0)), kTolerance);
  EXPECT_LT(glm::distance(axis(90, 0), glm::dvec3(-1, 0, 0)), kTolerance);
  EXPECT_LT(glm::distance(axis(180, 0), glm::dvec3(0, -1, 0)), kTolerance);
  EXPECT_LT(glm::distance(axis(0, 90), glm::dvec3(0, 0, -1)), kTolerance);
  EXPECT_LT(glm::distance(axis(0, -90), glm::dvec3(0, 0, 1)), kTolerance);
  // World z points up in the picture: the ray through the top edge's middle is higher than the central one.
  const hbCamera camera = hbCamera::framing(g, 30, 20, Projection::orthographic, 1.0);
  EXPECT_GT(camera.ray(50, 0, 100, 100).origin.z, camera.ray(50, 50, 100, 100).origin.z);
  EXPECT_NEAR(camera.ray(0, 50, 100, 100).origin.z, camera.ray(100, 50, 100, 100).origin.z, kTolerance * 4);
}

TEST(hbCamera, ZoomEnlargesWithoutMoving) {
  hbGeometry g;
  g.size = {5, 9, 3};
  for (const auto projection : {Projection::perspective, Projection::orthographic}) {
    const hbCamera one = hbCamera::framing(g, 10, 20, projection, 1.0);
    const hbCamera two = hbCamera::framing(g, 10, 20, projection, 1.0, 2.0);
    EXPECT_EQ(one.position, two.position);
    const glm::dvec3 corner = g.origin;
    EXPECT_LT(glm::distance(2.0 * projected(one, corner, 1.0), projected(two, corner, 1.0)), 64 * 0x1p-52);
  }
}

RC_GTEST_PROP(hbCamera, TheCentralRayIsTheViewAxis, ()) {
  const auto projection = *rc::gen::element(Projection::perspective, Projection::orthographic);
  const hbCamera camera = hbCamera::framing(anyGeometry(), real(-400, 400), real(-89, 89), projection, 1.5);
  const hbRay ray = camera.ray(150.0, 100.0, 300, 200);
  RC_ASSERT(glm::distance(ray.direction, camera.viewAxis()) < 8 * 0x1p-52);
  RC_ASSERT(ray.origin == camera.position);
}

TEST(hbCamera, OrthographicPixelsAreSquaresOfThePicturesHeight) {
  const hbCamera camera = lookingAlongY(Projection::orthographic);
  // 6 world units over 3 pixels: the top-left pixel of 4 x 3 lies 3 left of the centre and 2 above it.
  const hbRay ray = camera.ray(0.5, 0.5, 4, 3);
  EXPECT_LT(glm::distance(ray.origin, glm::dvec3(1.0 - 3.0, -10.0, 2.0 + 2.0)), 64 * 0x1p-52);
  EXPECT_EQ(ray.direction, glm::dvec3(0, 1, 0));
}

TEST(hbCamera, PerspectiveEdgesLieAtTheFieldOfView) {
  const hbCamera camera = lookingAlongY(Projection::perspective);
  // 90 degrees: at distance 1 the top edge is 1 above the axis, the right edge of a 4 x 2 picture 2 to the right.
  EXPECT_LT(glm::distance(camera.ray(2, 0, 4, 2).direction, glm::normalize(glm::dvec3(0, 1, 1))), 8 * 0x1p-52);
  EXPECT_LT(glm::distance(camera.ray(4, 1, 4, 2).direction, glm::normalize(glm::dvec3(2, 1, 0))), 8 * 0x1p-52);
  EXPECT_EQ(camera.ray(4, 1, 4, 2).origin, camera.position);
}

TEST(hbCamera, RefusesWhatCannotLook) {
  const auto with = [](auto change) {
    hbCamera camera = lookingAlongY(Projection::perspective);
    change(camera);
    return camera;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(with([](auto&) {}).validate());
  EXPECT_THROW(with([](auto& c) { c.target = c.position; }).validate(), hbError);
  EXPECT_THROW(with([](auto& c) { c.target.y = 1e200; }).validate(), hbError); // its distance overflows
  EXPECT_THROW(with([](auto& c) { c.up = {0, -3, 0}; }).validate(), hbError);
  EXPECT_THROW(with([](auto& c) { c.up = {0, 0, 0}; }).validate(), hbError);
  for (const double bad : {0.0, 180.0, -5.0, kNaN, kInf})
    EXPECT_THROW(with([&](auto& c) { c.fieldOfView = bad; }).validate(), hbError) << bad;
  for (const double bad : {0.0, -1.0, kNaN, kInf})
    EXPECT_THROW(with([&](auto& c) { c.height = bad; }).validate(), hbError) << bad;
  for (const double bad : {kNaN, kInf}) {
    EXPECT_THROW(with([&](auto& c) { c.position.x = bad; }).validate(), hbError);
    EXPECT_THROW(with([&](auto& c) { c.target.y = bad; }).validate(), hbError);
    EXPECT_THROW(with([&](auto& c) { c.up.z = bad; }).validate(), hbError);
  }
  try {
    with([](auto& c) { c.height = -2.0; }).validate("s.json: camera");
    FAIL();
  } catch (const hbError& e) {
    EXPECT_STREQ(e.what(), "s.json: camera: height: expected a positive finite number, found -2");
  }
}

TEST(hbCamera, FramingRefusesWhatIsNoView) {
  const hbGeometry g;
  constexpr auto kView = Projection::perspective;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(hbCamera::framing(g, kNaN, 0, kView, 1), hbError);
  EXPECT_THROW(hbCamera::framing(g, 0, 90.5, kView, 1), hbError);
  EXPECT_THROW(hbCamera::framing(g, 0, kNaN, kView, 1), hbError);
  EXPECT_THROW(hbCamera::framing(g, 0, 0, kView, 0), hbError);
  EXPECT_THROW(hbCamera::framing(g, 0, 0, kView, 1, -1), hbError);
  EXPECT_THROW(hbCamera::framing(g, 0, 0, kView, 1, kNaN), hbError);
  hbGeometry far; // a box that vanishes beside its origin
  far.origin.x = 1e30;
  EXPECT_THROW(hbCamera::framing(far, 90, 0, kView, 1), hbError);
}
