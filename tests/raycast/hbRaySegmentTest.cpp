#include "raycast/hbRaySegment.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/hbGeometry.h"

namespace {

glm::dmat4 unitCube() { return glm::dmat4(1.0); }

rc::Gen<double> between(double lo, double hi) {
  return rc::gen::map(rc::gen::inRange(0, 1 << 20), [=](int i) { return lo + (hi - lo) * i / (1 << 20); });
}

} // namespace

TEST(hbRaySegment, EntersAndLeavesAtTheFaces) {
  const auto s = hb::clipToCube({{0.5, -2.0, 0.25}, {0.0, 1.0, 0.0}}, unitCube());
  ASSERT_TRUE(s);
  EXPECT_EQ(s->enter, 2.0);
  EXPECT_EQ(s->leave, 3.0);
  EXPECT_EQ(s->at(2.5), glm::dvec3(0.5, 0.5, 0.25));
}

TEST(hbRaySegment, StartsAtTheOriginOfARayThatStartsInside) {
  const auto s = hb::clipToCube({{0.25, 0.5, 0.5}, {1.0, 0.0, 0.0}}, unitCube());
  ASSERT_TRUE(s);
  EXPECT_EQ(s->enter, 0.0);
  EXPECT_EQ(s->leave, 0.75);
}

TEST(hbRaySegment, MissesWhatIsBesideOrBehind) {
  EXPECT_FALSE(hb::clipToCube({{1.5, -2.0, 0.5}, {0.0, 1.0, 0.0}}, unitCube())); // parallel, beside
  EXPECT_FALSE(hb::clipToCube({{0.5, 2.0, 0.5}, {0.0, 1.0, 0.0}}, unitCube()));  // behind
  EXPECT_FALSE(hb::clipToCube({{-1.0, 0.5, 0.5}, glm::normalize(glm::dvec3(1, 4, 0))}, unitCube()));
  EXPECT_FALSE(
      hb::clipToCube({{-1.0, 1.0, 0.5}, glm::normalize(glm::dvec3(1, 1, 0))}, unitCube())); // leaves over the edge
  EXPECT_TRUE(hb::clipToCube({{1.0, -2.0, 0.5}, {0.0, 1.0, 0.0}}, unitCube()));             // along a face
}

RC_GTEST_PROP(hbRaySegment, SegmentsLieInTheCubeAndEndOnItsFaces, ()) {
  hbGeometry g;
  g.size = {3, 5, 9};
  g.spacing = {*between(0.1, 2.0), *between(0.1, 2.0), *between(0.001, 2.0)};
  g.origin = {*between(-9, 9), *between(-9, 9), *between(-9, 9)};
  const double angle = *between(0, 6.28);
  g.direction = glm::dmat3(glm::dvec3(std::cos(angle), std::sin(angle), 0),
                           glm::dvec3(-std::sin(angle), std::cos(angle), 0), glm::dvec3(0, 0, 1));
  // A ray through a point inside the box meets it.
  const glm::dvec3 through(g.cubeToWorld() *
                           glm::dvec4(*between(0.05, 0.95), *between(0.05, 0.95), *between(0.05, 0.95), 1.0));
  const glm::dvec3 origin(*between(-30, 30), *between(-30, 30), *between(-30, 30));
  RC_PRE(glm::distance(through, origin) > 1e-3);
  const auto s = hb::clipToCube({origin, glm::normalize(through - origin)}, glm::inverse(g.cubeToWorld()));
  RC_ASSERT(s.has_value());
  RC_ASSERT(s->enter >= 0.0 && s->enter < s->leave);
  // Rounding: coordinates of some tens, divided by edges down to 0.008 and multiplied by slopes as large: 1e-9 is
  // ample.
  constexpr double kTolerance = 1e-9;
  for (const double t : {s->enter, 0.5 * (s->enter + s->leave), s->leave}) {
    double toFace = 1.0;
    for (int d = 0; d < 3; ++d) {
      const double c = s->at(t)[d];
      RC_ASSERT(c >= -kTolerance && c <= 1.0 + kTolerance);
      toFace = std::min({toFace, std::abs(c), std::abs(1.0 - c)});
    }
    if (t == s->leave || (t == s->enter && t > 0.0)) RC_ASSERT(toFace <= kTolerance);
  }
}
