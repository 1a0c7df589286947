#include "glcombine/hbOglValues.h"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbOglPoints.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "tests/sparsegrid/hbTestPoints.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeField.h"

namespace {

class hbOglValuesTest : public testing::TestWithParam<hbGlContext::Kind> {
protected:
  hbOglValuesTest() : context_(hbGlContext::create(GetParam())), current_(*context_) {}

  std::vector<float> valuesAt(const hbOglValues& values, const hbTestPoints& points) const {
    std::vector<float> out(points.size());
    hbOglPoints(*context_, values).values(points.view(), out);
    return out;
  }

  void expectTheReference(const hbSparseGrid& grid, int component = 0) const {
    const hbOglValues combination(*context_, hbCombinationSparseGrid(grid), component),
        semiNodal(*context_, hbSemiNodalGrid(grid), component);
    for (const hbTestPoints& points : {hbTestPoints::random(500), hbTestPoints::awkward()}) {
      const std::vector<float> combined = valuesAt(combination, points), summed = valuesAt(semiNodal, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double exact = grid.calcValue(points.at(i), component);
        ASSERT_NEAR(combined[i], exact, hb::oglCombinationBound(grid, component)) << i;
        ASSERT_NEAR(summed[i], exact, hb::oglSemiNodalBound(grid, component)) << i;
      }
    }
  }

  std::unique_ptr<hbGlContext> context_;
  hbGlCurrent current_;
};

hbSparseGrid gridOf(const hbIndexSet& set, hbLatticeMapping mapping = hbLatticeMapping::fitted) {
  hbSize3 size = hbTestSets::sizeOf(set);
  // One sample less along refined axes: the aligned mapping then continues the volume.
  for (int d = 0; d < 3; ++d)
    if (mapping == hbLatticeMapping::aligned && set.finest()[d] > 1) --size[d];
  return hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(size), set, mapping);
}

std::string errorOf(const std::function<void()>& make) {
  try {
    make();
  } catch (const hbError& error) {
    return error.what();
  }
  return "no error";
}

} // namespace

TEST_P(hbOglValuesTest, AgreeWithTheReferenceAtEveryLevel) {
  for (int n = 1; n <= 8; ++n) {
    SCOPED_TRACE(n);
    expectTheReference(gridOf(hbIndexSet::regular(n, {})));
  }
}

TEST_P(hbOglValuesTest, AgreeForEveryKindOfAxisAndMapping) {
  const int kinds[] = {-1, 0, 1, 4}; // flat, of two nodes, of three, of more than most sets below have
  for (const int x : kinds)
    for (const int y : kinds)
      for (const int z : kinds) {
        SCOPED_TRACE(testing::Message() << x << " " << y << " " << z);
        const hbIndexSet::Axes axes{glm::max(glm::ivec3(x, y, z), 0), {x < 0, y < 0, z < 0}};
        const bool isAligned = (x + y + z) % 2 == 0;
        expectTheReference(gridOf(isAligned ? hbIndexSet::full(axes) : hbIndexSet::regular(3, axes),
                                  isAligned ? hbLatticeMapping::aligned : hbLatticeMapping::fitted));
      }
}

TEST_P(hbOglValuesTest, AgreeForSetsThatAreNotRegular) {
  for (const hbIndexSet& set :
       {hbIndexSet::anisotropic({6, 2, 4}, {}), hbIndexSet::anisotropic({1, 3, 5}, {}), hbTestSets::uneven()})
    for (const hbLatticeMapping mapping : {hbLatticeMapping::fitted, hbLatticeMapping::aligned})
      expectTheReference(gridOf(set, mapping));
}

TEST_P(hbOglValuesTest, TakeTheComponentAskedFor) {
  hbGeometry geometry;
  geometry.size = {3, 3, 2};
  std::vector<double> samples;
  for (int i = 0; i < 2 * 18; ++i) samples.push_back(std::sin(double(i * i)) + (i % 2 == 0 ? 0.0 : 10.0));
  const hbVolumeField field(hbVolume::fromSamples(geometry, std::move(samples), 2));
  const hbSparseGrid grid =
      hbSparseGrid::interpolate(field, hbIndexSet::full(hbIndexSet::axesOf(geometry.size)), hbLatticeMapping::fitted);
  expectTheReference(grid, 0);
  expectTheReference(grid, 1);
}

// What lies behind the last node of an axis belongs elsewhere: the step to it would be too large for 32 bits.
TEST_P(hbOglValuesTest, StepNoFartherThanTheLastNode) {
  const hbIndexSet set = hbIndexSet::full({glm::ivec3(1), glm::bvec3(false)});
  hbGeometry geometry;
  geometry.size = hbTestSets::sizeOf(set);
  for (int d = 0; d < 3; ++d) {
    std::vector<double> nodal; // from -2e38 to 2e38 along the axis
    for (const hbSubspace& subspace : set.subspaces())
      for (std::int64_t z = 0; z < subspace.nodes.z; ++z)
        for (std::int64_t y = 0; y < subspace.nodes.y; ++y)
          for (std::int64_t x = 0; x < subspace.nodes.x; ++x)
            nodal.push_back(subspace.levels[d] > 0 ? 0.0 : (hbSize3(x, y, z)[d] == 0 ? -2e38 : 2e38));
    expectTheReference(hbSparseGrid::fromNodalValues({geometry, {}, hbLatticeMapping::fitted}, set, {nodal}));
  }
}

// A term that is large and of either sign: the order must not let partial sums grow.
TEST_P(hbOglValuesTest, LoseLittleOfAConstantToTheOrderOfTerms) {
  const hbIndexSet set = hbIndexSet::regular(8, {});
  hbGeometry geometry;
  geometry.size = hbTestSets::sizeOf(set);
  const hbSparseGrid grid = hbSparseGrid::fromNodalValues({geometry, {}, hbLatticeMapping::fitted}, set,
                                                          {std::vector<double>(std::size_t(set.storedValues()), 0.1)});
  const hbOglValues values(*context_, hbCombinationSparseGrid(grid), 0);
  // Partial sums of at most 2 (see hbTermOrderTest), each rounded by half of 2^-24 times less than 0.25: 85 terms. In
  // the paper's order they reach 36 + 21.
  for (const float value : valuesAt(values, hbTestPoints::random(100))) EXPECT_NEAR(value, 0.1F, 85 * 0x1p-27);
}

TEST_P(hbOglValuesTest, RefuseWhatTheHardwareCannotTake) {
  const hbSparseGrid sparse = gridOf(hbIndexSet::regular(4, {}));
  const hbCombinationSparseGrid combination(sparse);
  const hbSemiNodalGrid semiNodal(sparse);
  const auto limits = hbOglValues::Limits::of(context_->gl());
  EXPECT_GE(limits.values, 65536); // OpenGL 3.3's least
  EXPECT_GE(limits.blockBytes, 16384);
  const auto check = [&](const auto& grid, std::int64_t blockBytes) {
    const auto count = std::int64_t(grid.values(0).size());
    EXPECT_EQ(hbOglValues(*context_, grid, 0, {{count, blockBytes}}).textureBytes(), 4 * count);
    EXPECT_EQ(errorOf([&] {
                hbOglValues(*context_, grid, 0, {{count - 1, blockBytes}});
              }),
              "texture buffer of a sparse grid: expected " + std::to_string(count - 1) + " values at most, found " +
                  std::to_string(count));
    EXPECT_EQ(errorOf([&] {
                hbOglValues(*context_, grid, 0, {{count, blockBytes - 1}});
              }),
              "uniform block of a sparse grid: expected " + std::to_string(blockBytes - 1) + " bytes at most, found " +
                  std::to_string(blockBytes));
  };
  // Two rows of 16 bytes a term, one more for each length of lines.
  check(combination, 32 * std::int64_t(combination.grids().size()));
  check(semiNodal, 32 * (4 + 6 * 2 + 3) + 16 * 4); // pairs of levels: both 1, one of them, none
}

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglValuesTest, testing::Values(hbGlContext::Kind::osmesa, hbGlContext::Kind::egl),
                         [](const auto& kind) { return kind.param == hbGlContext::Kind::egl ? "egl" : "osmesa"; });
