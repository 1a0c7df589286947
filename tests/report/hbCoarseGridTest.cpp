#include "report/hbCoarseGrid.h"

#include <gtest/gtest.h>

#include "tests/report/hbTestVolumes.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbVolumeField.h"

TEST(hbCoarseGrid, HasTheCubeOfItsSourceAndTheValuesAtItsNodes) {
  hbVolume volume = volumeOf({9, 5, 1}, 1, 2);
  hbGeometry geometry = volume.geometry();
  geometry.spacing = {1.0, 3.0, 2.0};
  geometry.origin = {5.0, 6.0, 7.0};
  volume.setGeometry(geometry);
  // Every other sample.
  const hbVolume coarse = hbCoarseGrid::sample(hbVolumeField(volume), 5);
  EXPECT_EQ(coarse.geometry().size, hbSize3(5, 3, 1));
  EXPECT_EQ(coarse.geometry().cubeToWorld(), geometry.cubeToWorld());
  for (int c = 0; c < 2; ++c)
    for (std::int64_t y = 0; y < 3; ++y)
      for (std::int64_t x = 0; x < 5; ++x) EXPECT_EQ(coarse.value(x, y, 0, c), volume.value(2 * x, 2 * y, 0, c));
}

TEST(hbCoarseGrid, KeepsTheProportionsAndTwoNodesAnAxis) {
  const hbVolumeField field(volumeOf({101, 51, 3}, 2));
  EXPECT_EQ(hbCoarseGrid::sample(field, 21).geometry().size, hbSize3(21, 11, 2));
  EXPECT_EQ(hbCoarseGrid::sample(field, 2).geometry().size, hbSize3(2, 2, 2));
}

TEST(hbCoarseGrid, IsTheFinestOneThatFits) {
  const auto field = hbAnalyticField::create("hydrogen,size=33");
  for (const std::uint64_t bytes : {300U, 2000U, 9000U, 30000U}) {
    const hbCoarseGrid best = hbCoarseGrid::within(*field, bytes);
    const std::int64_t longest = best.volume.geometry().size.x;
    EXPECT_LE(best.packed.size(), bytes);
    EXPECT_GT(hbCoarseGrid::take(*field, longest + 1).packed.size(), bytes) << longest;
  }
}

TEST(hbCoarseGrid, TakesASizeThatPacksBetterThanASmallerOne) {
  // Whole numbers at the samples and broken ones between them: nodes that are samples pack well.
  hbGeometry geometry;
  geometry.size = {61, 61, 61};
  std::vector<float> samples(std::size_t(geometry.samples()));
  std::uint32_t state = 1;
  for (float& sample : samples) sample = float((state = state * 1664525U + 1013904223U) >> 31U);
  const hbVolumeField field(hbVolume::fromSamples(geometry, std::move(samples)));
  // Of 31 nodes, every other sample; 28 nodes lie between samples.
  const std::uint64_t bytes = hbCoarseGrid::take(field, 31).packed.size();
  ASSERT_GT(hbCoarseGrid::take(field, 28).packed.size(), bytes);
  EXPECT_GE(hbCoarseGrid::within(field, bytes).volume.geometry().size.x, 31);
}

TEST(hbCoarseGrid, IsNoFinerThanTheSamplesAndNoCoarserThanTwoNodes) {
  const hbVolumeField field(volumeOf({6, 4, 5}, 3));
  EXPECT_EQ(hbCoarseGrid::within(field, std::uint64_t{1} << 40U).volume.geometry().size, hbSize3(6, 4, 5));
  EXPECT_EQ(hbCoarseGrid::within(field, 1).volume.geometry().size, hbSize3(2, 2, 2));
}

TEST(hbCoarseGrid, UnpacksWhatItPacked) {
  // Noise, which packing does not make smaller, and a constant, which it does.
  const hbVolume noise = volumeOf({7, 5, 3}, 4, 2);
  const hbVolume constant = hbVolume::fromSamples(noise.geometry(), std::vector<float>(105, 2.5F));
  for (const hbVolume& volume : {noise, constant}) {
    const hbCoarseGrid grid = hbCoarseGrid::take(hbVolumeField(volume), 7);
    const hbVolume back = hbCoarseGrid::unpack(grid.volume, grid.packed);
    for (int c = 0; c < volume.components(); ++c)
      for (std::int64_t z = 0; z < 3; ++z)
        for (std::int64_t y = 0; y < 5; ++y)
          for (std::int64_t x = 0; x < 7; ++x) EXPECT_EQ(back.value(x, y, z, c), volume.value(x, y, z, c));
  }
}

TEST(hbCoarseGrid, KeepsASmallSignalOnALargeConstant) {
  hbGeometry geometry;
  geometry.size = {3, 2, 2};
  std::vector<double> samples(12, 1e9);
  samples[4] += 0.001;
  const hbVolume volume = hbVolume::fromSamples(geometry, samples);
  const hbVolume coarse = hbCoarseGrid::sample(hbVolumeField(volume), 3);
  // A float's share of the signal, and the rounding of 1e9 in 64 bits.
  EXPECT_NEAR(coarse.value(1, 1, 0) - 1e9, 0.001, 0.001 * 0x1p-23 + 2.0 * 1e9 * 0x1p-53);
}
