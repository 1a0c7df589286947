#include "sparsegrid/hbComponentFiles.h"

#include <cmath>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbRoundingBounds.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbVolumeWriter.h"

namespace {

using Function = std::function<double(const glm::dvec3&, int component)>;

double wave(const glm::dvec3& p, int component) {
  return std::sin(3.0 * p.x + 0.5 + component) * std::cos(2.0 * p.y) + p.z * p.z;
}

/// A component grid's file: the function at its nodes, in the box from `origin` with edges of 8.
void writeGrid(const std::filesystem::path& path, const hbSize3& nodes, int components = 1, const Function& f = wave) {
  hbGeometry geometry;
  geometry.size = nodes;
  geometry.origin = {1.0, 2.0, 3.0};
  std::vector<double> samples;
  for (int d = 0; d < 3; ++d) geometry.spacing[d] = nodes[d] == 1 ? 8.0 : 8.0 / double(nodes[d] - 1);
  for (std::int64_t z = 0; z < nodes.z; ++z)
    for (std::int64_t y = 0; y < nodes.y; ++y)
      for (std::int64_t x = 0; x < nodes.x; ++x)
        for (int c = 0; c < components; ++c) {
          const auto at = [](std::int64_t i, std::int64_t n) { return n == 1 ? 0.5 : double(i) / double(n - 1); };
          samples.push_back(f({at(x, nodes.x), at(y, nodes.y), at(z, nodes.z)}, c));
        }
  hb::writeVolume(hbVolume::fromSamples(geometry, std::move(samples), components), path);
}

std::string nameOf(const glm::ivec3& l) { return fmt::format("u_{}_{}_{}.nrrd", l.x, l.y, l.z); }

void writeAll(const hbTestFolder& folder, const hbIndexSet& set, int components = 1) {
  for (const auto& grid : set.componentGrids()) writeGrid(folder / nameOf(grid.levels), grid.nodes, components);
}

std::string pattern(const hbTestFolder& folder) { return (folder / "u_{i}_{j}_{k}.nrrd").string(); }

} // namespace

// For an interpolating solver the combination is the sparse-grid interpolant itself.
RC_GTEST_PROP(hbComponentFiles, GiveTheInterpolant, ()) {
  const hbIndexSet set = hbIndexSet::regular(*rc::gen::inRange(1, 5), *hbTestSets::axes());
  const hbTestFolder folder;
  writeAll(folder, set, 2);
  const hbSparseGrid grid = hb::readComponentGrids(pattern(folder));
  RC_ASSERT(grid.indexSet().storedValues() == set.storedValues());
  RC_ASSERT(grid.indexSet().flat() == set.flat());
  RC_ASSERT(grid.components() == 2);
  RC_ASSERT(grid.geometry().size == hbTestSets::sizeOf(set));
  for (int d = 0; d < 3; ++d) RC_ASSERT(std::abs(grid.geometry().extent()[d] - 8.0) < 1e-12);
  for (int c = 0; c < 2; ++c) {
    const std::vector<double> values = grid.nodalValues(c);
    for (const hbSubspace& subspace : set.subspaces())
      for (std::int64_t i = 0; i < subspace.count(); ++i) {
        const hbSize3 k(i % subspace.nodes.x, i / subspace.nodes.x % subspace.nodes.y,
                        i / (subspace.nodes.x * subspace.nodes.y));
        glm::dvec3 p(0.5);
        for (int d = 0; d < 3; ++d)
          if (!set.flat()[d])
            p[d] = subspace.levels[d] == 0 ? double(k[d]) : double(2 * k[d] + 1) / std::exp2(subspace.levels[d]);
        // Surpluses are rounded to floats: half an ulp each of what adds up at a node.
        const double bound = 2.0 * hb::amplitude(grid, c) * 0x1p-24 + 1e-12;
        RC_ASSERT(std::abs(values[std::size_t(subspace.offset + i)] - wave(p, c)) <= bound);
      }
  }
}

TEST(hbComponentFiles, NamesMayHaveAnyOrderAndOtherFilesBesides) {
  const hbTestFolder folder;
  for (const auto& grid : hbIndexSet::regular(3, {{3, 2, 1}, {false, false, false}}).componentGrids())
    writeGrid(folder / fmt::format("z{}-x{}y{}.nrrd", grid.levels.z, grid.levels.x, grid.levels.y), grid.nodes);
  for (const char* name : {"z1-x1y.nrrd", "z1-x1y1.nrrd.bak", "z1-x1y99.nrrd", "z-1-x1y1.nrrd", "notes.txt"})
    std::ofstream(folder / name) << "something else";
  const hbSparseGrid grid = hb::readComponentGrids((folder / "z{k}-x{i}y{j}.nrrd").string());
  EXPECT_EQ(grid.indexSet().finest(), glm::ivec3(3, 2, 1));
}

TEST(hbComponentFiles, GridsOfCoefficientZeroMayBeMissing) {
  const hbTestFolder folder;
  const hbIndexSet set = hbIndexSet::regular(4, {});
  writeAll(folder, set);
  const hbSparseGrid without = hb::readComponentGrids(pattern(folder));
  writeGrid(folder / nameOf({1, 1, 1}), {3, 3, 3}, 1, [](const glm::dvec3&, int) { return 1e9; });
  const hbSparseGrid with = hb::readComponentGrids(pattern(folder)); // present, but it does not count
  EXPECT_TRUE(std::ranges::equal(with.surpluses(0), without.surpluses(0)));
}

TEST(hbComponentFiles, PatternsNeedEachBraceOnce) {
  for (const char* bad :
       {"u.nrrd", "u_{i}_{j}.nrrd", "u_{i}_{j}_{j}.nrrd", "u_{i}_{j}_{k}_{k}.nrrd", "{i}/{j}_{k}.nrrd", ""})
    EXPECT_HB_ERROR(hb::readComponentGrids(bad), "once each");
  const hbTestFolder folder;
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "found none");
  EXPECT_HB_ERROR(hb::readComponentGrids((folder / "none" / "{i}{j}{k}").string()), "found none");
}

TEST(hbComponentFiles, RefusesFilesThatDoNotFit) {
  const hbTestFolder folder;
  const hbIndexSet set = hbIndexSet::regular(3, {});
  writeAll(folder, set);
  // Not one of the finest, which would only make the set smaller: the others' coefficients need it.
  std::filesystem::remove(folder / nameOf({2, 1, 1}));
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "found none");
  writeGrid(folder / nameOf({2, 1, 1}), {5, 3, 3});
  const std::filesystem::path one = folder / nameOf({2, 2, 1});
  writeGrid(one, {5, 5, 5});
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "u_2_2_1.nrrd: expected 5 x 5 x 3 samples");
  writeGrid(one, {5, 5, 1});
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "u_2_2_1.nrrd: expected 5 x 5 x 3 samples");
  writeGrid(one, {5, 5, 3}, 2);
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "of 2");
  std::ofstream(one) << "damaged";
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "u_2_2_1.nrrd");
  writeGrid(one, {5, 5, 3}, 1, [](const glm::dvec3&, int) { return std::nan(""); });
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "finite");
  writeGrid(one, {5, 5, 3});
  EXPECT_NO_THROW(hb::readComponentGrids(pattern(folder)));
  // Level 0 stands for two nodes and no finer ones; beside level 1 it would be half a grid.
  writeGrid(folder / nameOf({0, 3, 1}), {2, 9, 3});
  EXPECT_HB_ERROR(hb::readComponentGrids(pattern(folder)), "levels from 1 along x, found 0 beside 3");
}

TEST(hbComponentFiles, CanBeInterrupted) {
  const hbTestFolder folder;
  writeAll(folder, hbIndexSet::regular(2, {}));
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hb::readComponentGrids(pattern(folder), {}, progress), hbCancelled);
}
