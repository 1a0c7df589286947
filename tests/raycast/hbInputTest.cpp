#include "raycast/hbInput.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "sparsegrid/hbCombinationSparseGrid.h"
#include "sparsegrid/hbSemiNodalGrid.h"
#include "tests/volume/hbTestFiles.h"
#include "volume/hbContainerWriter.h"
#include "volume/hbVolumeField.h"
#include "volume/hbVolumeWriter.h"

namespace {

/// x + 10 y + 100 z on 5 x 3 x 2 samples, two components, the second with 1000 more.
hbVolume smallVolume() {
  hbGeometry geometry;
  geometry.size = {5, 3, 2};
  geometry.spacing = {1.0, 2.0, 4.0};
  std::vector<float> samples;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 5; ++x)
        for (int c = 0; c < 2; ++c) samples.push_back(float(x + 10 * y + 100 * z + 1000 * c));
  return hbVolume::fromSamples(geometry, std::move(samples), 2);
}

void writeSparse(const std::filesystem::path& path) {
  const hbVolumeField field(smallVolume());
  hbSparseGridFile{
      hbSparseGrid::interpolate(field, hbIndexSet::full(hbIndexSet::axesOf({5, 3, 2})), hbLatticeMapping::fitted),
      {},
      {},
      {},
      {}}
      .write(path);
}

float valueAt(const hbField& field, float x, float y, float z, int component) {
  float value;
  field.values({{&x, 1}, {&y, 1}, {&z, 1}}, component, {&value, 1});
  return value;
}

} // namespace

TEST(hbInput, OpensAnalyticFields) {
  const hbInput input = hbInput::open("field:ball,radius=0.25,size=7x8x9", {});
  EXPECT_EQ(input.representation(), "analytic");
  EXPECT_EQ(input.geometry().size, hbSize3(7, 8, 9));
  EXPECT_EQ(input.components(), 1);
  EXPECT_EQ(input.fileBytes, 0U);
  EXPECT_EQ(input.name, "field:ball,radius=0.25,size=7x8x9");
  EXPECT_EQ(input.engine(hbEngine::automatic), hbEngine::full);
  EXPECT_EQ(valueAt(*input.field(hbEngine::automatic), 0.5F, 0.5F, 0.5F, 0), 1.0F);
  EXPECT_HB_ERROR(input.field(hbEngine::direct), "engine direct");
  EXPECT_HB_ERROR(input.field(hbEngine::combination), "engine combination");
  EXPECT_HB_ERROR(input.field(hbEngine::lattice), "the engine lattice cannot evaluate an analytic field");
  EXPECT_HB_ERROR(hbInput::open("field:", {}), "field");
  EXPECT_HB_ERROR(hbInput::open("field:balls", {}), "balls");
}

TEST(hbInput, OpensVolumes) {
  const hbTestFolder folder;
  hb::writeVolume(smallVolume(), folder / "v.nrrd");
  const hbInput input = hbInput::open((folder / "v.nrrd").string(), {});
  EXPECT_EQ(input.representation(), "volume");
  EXPECT_EQ(input.geometry(), smallVolume().geometry());
  EXPECT_EQ(input.components(), 2);
  EXPECT_EQ(input.fileBytes, std::filesystem::file_size(folder / "v.nrrd"));
  EXPECT_EQ(input.engine(hbEngine::automatic), hbEngine::full);
  EXPECT_EQ(valueAt(*input.field(hbEngine::full), 0.5F, 0.5F, 1.0F, 1), 1112.0F);
  EXPECT_HB_ERROR(input.field(hbEngine::direct), "v.nrrd: the engine direct cannot evaluate a plain volume");
}

TEST(hbInput, OpensRawFilesAsTold) {
  const hbTestFolder folder;
  hb::test::writeFile(folder / "r.nrrd", std::vector<std::byte>(8, std::byte{9}));
  hbReadOptions options;
  options.raw = hbRawLayout{};
  options.raw->size = {2, 2, 2};
  const hbInput input = hbInput::open((folder / "r.nrrd").string(), options);
  EXPECT_EQ(input.representation(), "volume");
  EXPECT_EQ(input.volume->value(1, 1, 1), 9.0);
  // A sparse grid beside it still is one, so that both can be compared.
  writeSparse(folder / "grid.hbv");
  EXPECT_EQ(hbInput::open((folder / "grid.hbv").string(), options).representation(), "sparse");
}

TEST(hbInput, OpensSparseGridsWhateverTheirName) {
  const hbTestFolder folder;
  for (const char* name : {"grid.hbv", "grid.nrrd", "grid"}) {
    writeSparse(folder / name);
    const hbInput input = hbInput::open((folder / name).string(), {});
    EXPECT_EQ(input.representation(), "sparse");
    EXPECT_EQ(input.geometry(), smallVolume().geometry());
    EXPECT_EQ(input.components(), 2);
    EXPECT_EQ(input.fileBytes, std::filesystem::file_size(folder / name));
    EXPECT_EQ(input.engine(hbEngine::automatic), hbEngine::seminodal);
    EXPECT_NE(dynamic_cast<const hbSemiNodalGrid*>(input.field(hbEngine::automatic).get()), nullptr);
    EXPECT_NE(dynamic_cast<const hbSparseGrid*>(input.field(hbEngine::direct).get()), nullptr);
    EXPECT_EQ(input.engine(hbEngine::combination), hbEngine::combination);
    // Values below 2048 of a linear function: a few roundings.
    EXPECT_NEAR(valueAt(*input.field(hbEngine::automatic), 0.5F, 0.5F, 1.0F, 1), 1112.0F, 8 * 2048 * 0x1p-24);
    EXPECT_NE(dynamic_cast<const hbCombinationSparseGrid*>(input.field(hbEngine::combination).get()), nullptr);
    EXPECT_NEAR(valueAt(*input.field(hbEngine::combination), 0.5F, 0.5F, 1.0F, 0), 112.0F, 8 * 2048 * 0x1p-24);
    EXPECT_EQ(input.field(hbEngine::lattice).get(), &input.sparse->grid);
    const hbIndexSet& set = input.sparse->grid.indexSet();
    EXPECT_EQ(input.fieldBytes(hbEngine::lattice),
              2.0 * 2.0 * 4.0 * double(set.storedValues()) + hbSemiNodalGrid::bytes(set, 2));
    // Extracted: 5 x 3 x 2 samples of two components.
    EXPECT_NE(dynamic_cast<const hbVolumeField*>(input.field(hbEngine::full).get()), nullptr);
    EXPECT_NEAR(valueAt(*input.field(hbEngine::full), 0.5F, 0.5F, 1.0F, 1), 1112.0F, 32 * 2048 * 0x1p-24);
    EXPECT_EQ(input.fieldBytes(hbEngine::full), 2.0 * 4.0 * 30.0);
  }
}

TEST(hbInput, AFieldKeepsItsDataAlive) {
  const hbTestFolder folder;
  writeSparse(folder / "grid.hbv");
  std::shared_ptr<const hbField> field;
  {
    const hbInput input = hbInput::open((folder / "grid.hbv").string(), {});
    field = input.field(hbEngine::direct);
  }
  EXPECT_NEAR(valueAt(*field, 0.0F, 0.0F, 0.0F, 1), 1000.0F, 2048 * 0x1p-24);
}

TEST(hbInput, ReplacesSamplesThatAreNotFinite) {
  const hbTestFolder folder;
  hbGeometry geometry;
  geometry.size = {2, 1, 1};
  hb::writeVolume(hbVolume::fromSamples(geometry, std::vector<float>{1.0F, std::numeric_limits<float>::quiet_NaN()}),
                  folder / "v.nrrd");
  const hbInput input = hbInput::open((folder / "v.nrrd").string(), {});
  EXPECT_TRUE(std::isnan(valueAt(*input.field(hbEngine::full), 1.0F, 0.0F, 0.0F, 0)));
  const auto replaced = input.field(hbEngine::full, -3.0);
  EXPECT_EQ(replaced->valueMap().toTrue(double(valueAt(*replaced, 1.0F, 0.0F, 0.0F, 0))), -3.0);
}

TEST(hbInput, RefusesWhatIsNoInput) {
  const hbTestFolder folder;
  EXPECT_HB_ERROR(hbInput::open((folder / "none.hbv").string(), {}), "none.hbv");
  EXPECT_HB_ERROR(hbInput::open(folder.path().string(), {}), folder.path().string());
  EXPECT_HB_ERROR(hbInput::open("", {}), "");
  // A container with nothing of ours in it; a wait for a pipe's writer would never end.
  {
    hbContainerWriter writer(folder / "empty.hbv");
    writer.commit();
  }
  EXPECT_HB_ERROR(hbInput::open((folder / "empty.hbv").string(), {}), "expected a sparse grid");
  ASSERT_EQ(::mkfifo((folder / "pipe.nrrd").c_str(), 0600), 0);
  EXPECT_HB_ERROR(hbInput::open((folder / "pipe.nrrd").string(), {}), "device or pipe");
  writeSparse(folder / "grid.hbv");
  hbReadOptions little;
  little.memoryLimit = 100;
  EXPECT_HB_ERROR(hbInput::open((folder / "grid.hbv").string(), little), "grid.hbv");
}
