// Every kernel with every instruction set that this machine has: the same values to the last bit, and those of the
// evaluation without vector instructions where there is one.

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbHierarchise.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "tests/sparsegrid/hbTestPoints.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbInstructionSet.h"

namespace {

/// Uses one set after the other, and in the end the best again.
class Sets {
public:
  Sets() = default;
  Sets(const Sets&) = delete;
  Sets& operator=(const Sets&) = delete;
  ~Sets() { hb::useInstructionSet(""); }
  const std::vector<std::string> names = hb::instructionSets();
};

hbSparseGrid gridOf(const hbIndexSet& set, hbLatticeMapping mapping) {
  return hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(hbTestSets::sizeOf(set)), set, mapping);
}

template <class Field>
void expectTheSameWithEverySet(const Field& field, const hbTestPoints& points) {
  const Sets sets;
  const hbTestPoints64 points64(points);
  hb::useInstructionSet(sets.names.front());
  const hbTestValues<float> values(field, points.view());
  const hbTestValues<double> values64(field, points64.view());
  for (const std::string& name : sets.names) {
    hb::useInstructionSet(name);
    ASSERT_TRUE(hbTestValues<float>(field, points.view()) == values) << name;
    ASSERT_TRUE(hbTestValues<double>(field, points64.view()) == values64) << name;
  }
}

void expectTheSame(const hbSparseGrid& grid, const hbTestPoints& points) {
  const hbCombinationSparseGrid combination(grid);
  expectTheSameWithEverySet(grid, points);
  expectTheSameWithEverySet(combination, points);
  expectTheSameWithEverySet(hbSemiNodalGrid(grid), points);

  const hbTestPoints64 points64(points);
  const hbTestValues<float> direct(grid, points.view()), combined(combination, points.view());
  const hbTestValues<double> direct64(grid, points64.view());
  for (std::size_t i = 0; i < points.size(); ++i) {
    glm::vec3 slopes;
    glm::dvec3 slopes64;
    ASSERT_EQ(direct.value[i], grid.calcValue32(points.at(i), 0)) << i;
    ASSERT_EQ(direct.valueAgain[i], grid.calcValue32(points.at(i), 0, slopes)) << i;
    ASSERT_EQ(direct.gradient(i), slopes) << i;
    ASSERT_EQ(direct64.valueAgain[i], grid.calcValue(points.at(i), 0, slopes64)) << i;
    ASSERT_EQ(direct64.gradient(i), slopes64) << i;
    ASSERT_EQ(combined.value[i], combination.calcValue32(points.at(i), 0)) << i;
    ASSERT_EQ(combined.valueAgain[i], combined.value[i]) << i;
  }
}

} // namespace

TEST(instructionSets, GiveTheSameValuesAtEveryLevel) {
  for (int n = 1; n <= 11; n += 2) {
    SCOPED_TRACE(n);
    const hbSparseGrid grid = gridOf(hbIndexSet::regular(n, {}), hbLatticeMapping::fitted);
    expectTheSame(grid, hbTestPoints::random(133));
  }
}

RC_GTEST_PROP(instructionSets, GiveTheSameValuesForAnyIndexSet, ()) {
  const hbSparseGrid grid =
      gridOf(*hbTestSets::any(), *rc::gen::element(hbLatticeMapping::fitted, hbLatticeMapping::aligned));
  expectTheSame(grid, hbTestPoints::awkward());
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(instructionSets, HierarchiseToTheSameSurpluses, ()) {
  const Sets sets;
  // Full sets up to level 7: lines long enough for every path, groups that are cut both ways; and any other set.
  const hbIndexSet set =
      *rc::gen::oneOf(hbTestSets::any(), rc::gen::map(rc::gen::inRange(4, 8), [](int finest) {
                        return hbIndexSet::full({{finest, finest - 3, finest}, {false, false, false}});
                      }));
  std::vector<double> nodal;
  std::mt19937 random(7);
  for (std::int64_t i = 0; i < set.storedValues(); ++i) nodal.push_back(double(random()) / 1000.0);
  std::vector<double> surpluses, back;
  for (const std::string& name : sets.names) {
    hb::useInstructionSet(name);
    std::vector<double> values = nodal;
    hb::hierarchise(set, values);
    if (surpluses.empty()) surpluses = values;
    RC_ASSERT(values == surpluses);
    hb::dehierarchise(set, values);
    if (back.empty()) back = values;
    RC_ASSERT(values == back);
  }
}
