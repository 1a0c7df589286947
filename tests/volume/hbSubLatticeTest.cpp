#include "volume/hbSubLattice.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/volume/hbTestFiles.h"

namespace {

/// A sheared, turned and shifted one.
hbGeometry geometryOf(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  g.origin = {-3.0, 5.0, 100.0};
  g.spacing = {0.5, 2.0, 0.3};
  g.direction = glm::dmat3(glm::normalize(glm::dvec3(1, 2, 3)), glm::normalize(glm::dvec3(-1, 1, 0)),
                           glm::normalize(glm::dvec3(0, 1, -4)));
  g.centring = hbGeometry::Centring::cell;
  g.space = "scanner-xyz";
  return g;
}

glm::dvec3 world(const hbGeometry& g, const glm::dvec3& sample) {
  return g.origin + g.direction * (g.spacing * sample);
}

rc::Gen<hbSize3> sizes() {
  return rc::gen::map(rc::gen::container<std::vector<int>>(3, rc::gen::inRange(1, 40)),
                      [](const std::vector<int>& n) { return hbSize3(n[0], n[1], n[2]); });
}

/// A random box: first and last sample.
std::pair<hbSize3, hbSize3> boxIn(const hbSize3& size) {
  hbSize3 first, last;
  for (int d = 0; d < 3; ++d) {
    first[d] = *rc::gen::inRange<std::int64_t>(0, size[d]);
    last[d] = *rc::gen::inRange<std::int64_t>(first[d], size[d]);
  }
  return {first, last};
}

/// Positions below 256 after a few operations.
constexpr double kRounding = 256 * 0x1p-50;

} // namespace

RC_GTEST_PROP(hbSubLattice, BoxesAndLevelsOfDetailAreSamplesAtTheirPlaces, ()) {
  const hbGeometry source = geometryOf(*sizes());
  const auto [first, last] = boxIn(source.size);
  const int lod = *rc::gen::inRange(0, 7);
  const hbSubLattice lattice = hbSubLattice(source).box(first, last).thinned(lod);
  const hbGeometry made = lattice.geometry();
  made.validate("made");
  RC_ASSERT(made.size == lattice.size());
  RC_ASSERT(made.direction == source.direction);
  RC_ASSERT(made.centring == source.centring);
  RC_ASSERT(made.space == source.space);
  for (int d = 0; d < 3; ++d) {
    const std::int64_t cells = last[d] - first[d], step = cells == 0 ? 1 : std::min<std::int64_t>(1 << lod, cells);
    RC_ASSERT(made.size[d] == cells / step + 1);
    RC_ASSERT(cells == 0 || made.size[d] >= 2);
    const auto all = source.cubeCoordinates(d), some = lattice.cubeCoordinates(d);
    RC_ASSERT(std::int64_t(some.size()) == made.size[d]);
    for (std::int64_t k = 0; k < made.size[d]; ++k)
      RC_ASSERT(some[std::size_t(k)] == all[std::size_t(first[d] + k * step)]);
    glm::dvec3 there(0.0), here(first);
    there[d] = double(made.size[d] - 1);
    here[d] += double(step) * there[d];
    RC_ASSERT(glm::distance(world(made, there), world(source, here)) < kRounding);
  }
}

RC_GTEST_PROP(hbSubLattice, AnotherSizeKeepsTheBox, ()) {
  const hbGeometry source = geometryOf(*sizes());
  auto [first, last] = boxIn(source.size);
  for (int d = 0; d < 3; ++d)
    if (first[d] == last[d]) first[d] = 0, last[d] = source.size[d] - 1;
  const hbSize3 size = *sizes();
  const hbSubLattice lattice = hbSubLattice(source).box(first, last).resized(size);
  const hbGeometry made = lattice.geometry();
  RC_ASSERT(made.size == size);
  // The same cube in the world as the box's own, and its evenly spaced places.
  const glm::dmat4 found = made.cubeToWorld(),
                   expected = hbSubLattice(source).box(first, last).geometry().cubeToWorld();
  for (int column = 0; column < 4; ++column) RC_ASSERT(glm::distance(found[column], expected[column]) < kRounding);
  for (int d = 0; d < 3; ++d) {
    const auto places = lattice.cubeCoordinates(d);
    RC_ASSERT(std::int64_t(places.size()) == size[d]);
    const double cells = double(source.size[d] - 1);
    const double from = source.isFlat(d) ? 0.0 : double(first[d]) / cells,
                 to = source.isFlat(d) ? 1.0 : double(last[d]) / cells;
    for (std::int64_t k = 0; k < size[d]; ++k) {
      const double t = size[d] == 1 ? 0.5 : double(k) / double(size[d] - 1);
      RC_ASSERT(std::abs(places[std::size_t(k)] - (from + t * (to - from))) < 0x1p-50);
      // Over the whole box they are those of a volume of that size, to the last bit.
      if (to - from == 1.0) RC_ASSERT(places[std::size_t(k)] == t);
    }
  }
}

TEST(hbSubLattice, AFlatAxisHasItsMiddleOrItsWholeThickness) {
  const hbGeometry source = geometryOf({5, 4, 1});
  EXPECT_EQ(hbSubLattice(source).geometry(), source);
  EXPECT_EQ(hbSubLattice(source).thinned(3).cubeCoordinates(2), std::vector{0.5});
  EXPECT_EQ(hbSubLattice(source).resized({5, 4, 3}).cubeCoordinates(2), (std::vector{0.0, 0.5, 1.0}));
  EXPECT_EQ(hbSubLattice(source).resized({1, 4, 1}).cubeCoordinates(0), std::vector{0.5});
  EXPECT_EQ(hbSubLattice(source).resized({1, 4, 1}).geometry().spacing.x, 4 * 0.5);
  // One sample of an axis that is not flat.
  const hbSubLattice slice = hbSubLattice(source).box({1, 0, 0}, {1, 3, 0});
  EXPECT_EQ(slice.cubeCoordinates(0), std::vector{0.25});
  EXPECT_EQ(slice.geometry().spacing, source.spacing);
  EXPECT_EQ(slice.resized({1, 7, 1}).cubeCoordinates(0), std::vector{0.25});
  EXPECT_HB_ERROR(slice.resized({2, 7, 1}), "size: expected 1 along x, where the box has one sample, found 2");
}

TEST(hbSubLattice, RefusesBoxesOutside) {
  const hbSubLattice all(geometryOf({5, 4, 1}));
  EXPECT_HB_ERROR(all.box({0, 0, 0}, {5, 3, 0}), "from 0:0 to 4:4 along x, found 0:5");
  EXPECT_HB_ERROR(all.box({0, -1, 0}, {4, 3, 0}), "from 0:0 to 3:3 along y, found -1:3");
  EXPECT_HB_ERROR(all.box({0, 3, 0}, {4, 2, 0}), "along y, found 3:2");
  EXPECT_HB_ERROR(all.box({0, 0, 1}, {4, 3, 1}), "along z, found 1:1");
  // Steps start from what there is.
  EXPECT_EQ(all.box({1, 0, 0}, {4, 3, 0}).box({1, 0, 0}, {2, 3, 0}).cubeCoordinates(0), (std::vector{0.5, 0.75}));
  EXPECT_HB_ERROR(all.thinned(1).box({0, 0, 0}, {3, 0, 0}), "from 0:0 to 2:2 along x");
}
