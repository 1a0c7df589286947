#include "volume/hbGeometry.h"

#include <limits>

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "volume/hbError.h"

TEST(hbGeometry, CubeCornersAreTheFirstAndLastSample) {
  hbGeometry g;
  g.size = {5, 3, 2};
  g.origin = {1.0, -2.0, 3.0};
  g.spacing = {0.5, 2.0, 4.0};
  g.direction = glm::dmat3(glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 0, 1));
  const glm::dmat4 m = g.cubeToWorld();
  EXPECT_EQ(glm::dvec3(m * glm::dvec4(0, 0, 0, 1)), g.origin);
  // x runs 4 * 0.5 along +y, y runs 2 * 2 along -x, z runs 4 along +z.
  EXPECT_EQ(glm::dvec3(m * glm::dvec4(1, 1, 1, 1)), glm::dvec3(1.0 - 4.0, -2.0 + 2.0, 3.0 + 4.0));
}

TEST(hbGeometry, FlatAxisHasTheThicknessOfOneSpacingAroundItsSample) {
  hbGeometry g;
  g.size = {5, 3, 1};
  g.origin = {0.0, 0.0, 10.0};
  g.spacing = {1.0, 1.0, 2.0};
  EXPECT_EQ(g.extent(), glm::dvec3(4.0, 2.0, 2.0));
  const glm::dmat4 m = g.cubeToWorld();
  EXPECT_EQ(glm::dvec3(m * glm::dvec4(0, 0, 0, 1)).z, 9.0);
  EXPECT_EQ(glm::dvec3(m * glm::dvec4(0, 0, 1, 1)).z, 11.0);
  EXPECT_EQ(g.cubeSpacing(), glm::dvec3(0.25, 0.5, 1.0));
}

TEST(hbGeometry, RefusesWhatIsNoGrid) {
  const auto with = [](auto change) {
    hbGeometry g;
    g.size = {4, 4, 4};
    change(g);
    return g;
  };
  EXPECT_NO_THROW(with([](auto&) {}).validate("x"));
  EXPECT_THROW(with([](auto& g) { g.size.y = 0; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) {
                 g.size = {std::int64_t{1} << 30, std::int64_t{1} << 30, 1};
               }).validate("x"),
               hbError);
  EXPECT_THROW(with([](auto& g) { g.size = {std::numeric_limits<std::int64_t>::max(), 2, 2}; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.spacing.x = 0.0; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.spacing.x = std::numeric_limits<double>::quiet_NaN(); }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.origin.z = std::numeric_limits<double>::infinity(); }).validate("x"), hbError);
  // Edges whose product leaves the range of 64-bit floats could not be inverted.
  EXPECT_THROW(with([](auto& g) { g.spacing.x = 1e81; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.spacing.y = 1e-81; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.origin.x = -1e81; }).validate("x"), hbError);
  for (const double extreme : {1e80, 1e-80}) {
    const hbGeometry g = with([&](auto& e) {
      e.spacing = glm::dvec3(extreme);
      e.origin = glm::dvec3(extreme);
    });
    EXPECT_NO_THROW(g.validate("x"));
    const glm::dvec3 corner(glm::inverse(g.cubeToWorld()) * g.cubeToWorld() * glm::dvec4(1.0));
    // Some dozens of products and sums of numbers of one size, in 64 bits.
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(corner[d], 1.0, 64 * 0x1p-53);
  }
  EXPECT_THROW(with([](auto& g) { g.direction[1] = g.direction[0]; }).validate("x"), hbError);
  EXPECT_THROW(with([](auto& g) { g.direction[1] *= 2.0; }).validate("x"), hbError);
}
