#include "report/hbSparseCompression.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/volume/hbTestFiles.h"
#include "volume/hbVolumeField.h"

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

hbInput inputOf(hbVolume volume) {
  hbInput input;
  input.name = "the volume";
  input.volume = std::make_shared<const hbVolume>(std::move(volume));
  return input;
}

hbInput roughInput(const hbSize3& size, int components = 1) {
  hbGeometry g;
  g.size = size;
  std::vector<float> samples(std::size_t(g.samples() * components));
  std::uint32_t state = 5;
  for (float& sample : samples) sample = float((state = state * 1664525U + 1013904223U) >> 24U);
  return inputOf(hbVolume::fromSamples(g, std::move(samples), components));
}

hbInput fieldInput(const std::string& name) { return hbInput::open("field:" + name, {}); }

} // namespace

TEST(hbSparseCompression, AFieldAtALevelStandsForItsFullGrid) {
  hbSparseCompression how;
  how.set.levels = glm::ivec3(5);
  const hbSparseGridFile file = how.compress(fieldInput("smooth,size=9x2x1")).file;
  EXPECT_EQ(file.grid.geometry().size, hbSize3(33, 2, 1));
  EXPECT_FALSE(file.range); // the field's own is not known
  ASSERT_TRUE(file.error);
  EXPECT_EQ(file.error->components[0].reference, hbErrorRecord::Reference::analyticField);
  EXPECT_EQ(file.error->components[0].points, std::uint64_t(hbSparseCompression::kRandomPoints));
  how.set.levels = {4, 6, 3};
  EXPECT_EQ(how.compress(fieldInput("smooth,size=9")).file.grid.geometry().size, hbSize3(17, 65, 9));
  how.set.levels = glm::ivec3(20);
  EXPECT_HB_ERROR(how.compress(fieldInput("smooth")), "fewer than 2^60 samples, found 20,20,20");
}

TEST(hbSparseCompression, RecordsRangeAndSource) {
  hbInput input = roughInput({9, 8, 7}, 2);
  hbVolume volume = *input.volume;
  volume.setSlopeIntercept(-2.0, 10.0);
  volume.setComponentNames({"u", "v"});
  input = inputOf(volume);
  const hbSparseGridFile file = hbSparseCompression{}.compress(input).file;
  EXPECT_EQ(file.info.slope, -2.0);
  EXPECT_EQ(file.info.intercept, 10.0);
  EXPECT_EQ(file.info.sampleType, hbSampleType::float32);
  EXPECT_EQ(file.info.componentNames, (std::vector<std::string>{"u", "v"}));
  ASSERT_TRUE(file.range);
  for (int c = 0; c < 2; ++c) {
    double lo = 1e9, hi = -1e9;
    for (int i = 0; i < 9 * 8 * 7; ++i) {
      const double v = volume.value(i % 9, i / 9 % 8, i / 72, c);
      lo = std::min(lo, v);
      hi = std::max(hi, v);
    }
    EXPECT_EQ(file.range->components[std::size_t(c)], (hbRangeRecord::Component{lo, hi}));
  }
}

TEST(hbSparseCompression, RecordsTheErrorThatIsThere) {
  const hbInput input = roughInput({17, 12, 9}, 2);
  for (const hbLatticeMapping mapping : {hbLatticeMapping::fitted, hbLatticeMapping::aligned})
    for (const int level : {1, 3}) {
      hbSparseCompression how;
      how.set.levels = glm::ivec3(level);
      how.mapping = mapping;
      const hbSparseGridFile file = how.compress(input).file;
      ASSERT_TRUE(file.error);
      for (int c = 0; c < 2; ++c) {
        double max = 0.0, sum = 0.0;
        for (int z = 0; z < 9; ++z)
          for (int y = 0; y < 12; ++y)
            for (int x = 0; x < 17; ++x) {
              const double e =
                  float(file.grid.calcValue({x / 16.0, y / 11.0, z / 8.0}, c)) - input.volume->value(x, y, z, c);
              max = std::max(max, std::abs(e));
              sum += e * e;
            }
        const double count = 17 * 12 * 9;
        const hbErrorRecord::Component& record = file.error->components[std::size_t(c)];
        EXPECT_EQ(record.reference, hbErrorRecord::Reference::allSamples);
        EXPECT_EQ(record.kind, hbErrorRecord::Kind::measured);
        EXPECT_EQ(record.points, std::uint64_t(count));
        // Both round a 64-bit sum to a float once, perhaps to neighbours: values below 2048.
        const double ulp = 2048 * 0x1p-23;
        EXPECT_NEAR(record.max, max, ulp);
        EXPECT_NEAR(record.rmse, std::sqrt(sum / count), ulp);
        const hbRangeRecord::Component& range = file.range->components[std::size_t(c)];
        EXPECT_NEAR(record.psnr, 20.0 * std::log10((range.hi - range.lo) / record.rmse), 1e-9);
      }
    }
}

TEST(hbSparseCompression, SampledErrorsComeCloseToAllOfThem) {
  const hbInput input = roughInput({40, 30, 20});
  hbSparseCompression how;
  how.set.levels = glm::ivec3(3);
  const hbErrorRecord::Component all = how.compress(input).file.error->components[0];
  how.measure = hbSparseCompression::Measure::sampled;
  const hbErrorRecord::Component sampled = how.compress(input).file.error->components[0];
  EXPECT_EQ(sampled.reference, hbErrorRecord::Reference::randomSamples);
  EXPECT_EQ(sampled.points, std::uint64_t(hbSparseCompression::kRandomSamples));
  // 2^20 draws, squared errors of a relative spread below 2: five standard deviations, halved by the root.
  EXPECT_NEAR(sampled.rmse, all.rmse, 0.5 * 5 * 2 / 1024.0 * all.rmse);
  EXPECT_LE(sampled.max, all.max + 2048 * 0x1p-23);
  how.measure = hbSparseCompression::Measure::none;
  EXPECT_FALSE(how.compress(input).file.error);
}

TEST(hbSparseCompression, NothingLostIsAnInfinitePsnr) {
  hbGeometry g;
  g.size = {3, 3, 3};
  const hbErrorRecord::Component error = hbSparseCompression{}
                                             .compress(inputOf(hbVolume::fromSamples(g, std::vector<float>(27, 4.0F))))
                                             .file.error->components[0];
  EXPECT_EQ(error.max, 0.0);
  EXPECT_EQ(error.psnr, std::numeric_limits<double>::infinity());
}

TEST(hbSparseCompression, RefusesOrReplacesNonFiniteSamples) {
  hbGeometry g;
  g.size = {4, 4, 4};
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    std::vector<float> samples(64, 1.0F);
    samples[21] = bad; // inside, no node of level 1
    hbSparseCompression how;
    how.set.levels = glm::ivec3(1);
    for (const auto measure : {hbSparseCompression::Measure::automatic, hbSparseCompression::Measure::none}) {
      how.measure = measure;
      how.nonFinite.reset();
      EXPECT_HB_ERROR(how.compress(inputOf(hbVolume::fromSamples(g, samples))), "the volume: expected finite samples");
      how.nonFinite = 5.0;
      const hbSparseGridFile file = how.compress(inputOf(hbVolume::fromSamples(g, samples))).file;
      EXPECT_EQ(file.range->components[0], (hbRangeRecord::Component{1.0, 5.0}));
      EXPECT_EQ(file.error.has_value(), measure == hbSparseCompression::Measure::automatic);
    }
  }
  // Nothing finite at all.
  hbSparseCompression how;
  how.nonFinite = 2.0;
  const hbSparseGridFile file = how.compress(inputOf(hbVolume::fromSamples(g, std::vector<float>(64, kNan)))).file;
  EXPECT_EQ(file.range->components[0], (hbRangeRecord::Component{2.0, 2.0}));
  EXPECT_EQ(file.grid.calcValue({0.3, 0.4, 0.5}, 0), 2.0);
}

TEST(hbSparseCompression, LargeVolumesAreNotScanned) {
  // 2^27 + ... samples in a sparse file, of which one, the first, is not zero and another one is NaN.
  const hbTestFolder folder;
  const auto path = folder / "large_513x513x513_float32.raw";
  constexpr std::int64_t kSide = 513;
  hb::test::writeFile(path, {});
  std::filesystem::resize_file(path, std::uintmax_t(kSide * kSide * kSide * 4));
  const int file = ::open(path.c_str(), O_WRONLY);
  const auto poke = [&](std::int64_t x, std::int64_t y, std::int64_t z, float value) {
    ASSERT_EQ(::pwrite(file, &value, 4, 4 * (x + kSide * (y + kSide * z))), 4);
  };
  poke(0, 0, 0, 8.0F);
  poke(3, 5, 7, kNan);
  hbSparseCompression how;
  how.set.levels = glm::ivec3(4);
  how.measure = hbSparseCompression::Measure::none;
  const hbSparseGridFile grid = how.compress(hbInput::open(path.string(), {})).file;
  EXPECT_FALSE(grid.range);
  EXPECT_EQ(grid.grid.calcValue({0, 0, 0}, 0), 8.0);
  EXPECT_EQ(grid.grid.calcValue({1, 1, 0.5}, 0), 0.0);
  // At a node it is noticed all the same, and so is one that a full scan finds.
  poke(256, 256, 256, kNan);
  EXPECT_HB_ERROR(how.compress(hbInput::open(path.string(), {})), "--nan-value");
  ::close(file);
}

TEST(hbSparseCompression, ChecksMemoryAndInput) {
  hbSparseCompression how;
  how.set.levels = glm::ivec3(8);
  how.memoryLimit = 21249 * 23;
  EXPECT_HB_ERROR(how.compress(fieldInput("smooth")), "memory limit");
  how.memoryLimit = 21249 * 24;
  how.measure = hbSparseCompression::Measure::none;
  EXPECT_NO_THROW(how.compress(fieldInput("smooth")));

  hbInput sparse;
  sparse.name = "grid";
  sparse.sparse = std::make_shared<const hbSparseGridFile>(how.compress(fieldInput("smooth")).file);
  EXPECT_HB_ERROR(how.compress(sparse), "grid: expected a volume or a field, found a sparse grid");
}

TEST(hbSparseCompression, CanBeInterrupted) {
  hbProgress progress;
  progress.cancel();
  EXPECT_THROW(hbSparseCompression{}.compress(roughInput({9, 9, 9}), progress), hbCancelled);
  EXPECT_THROW(hbSparseCompression{}.compress(fieldInput("smooth,size=9"), progress), hbCancelled);
}
