// The values of hbVolumeField by vector instructions against those point by point, to the last bit, with every
// instruction set that this machine has.

#include "volume/kernels/hbTrilinearKernel.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/mman.h>

#include "volume/hbInstructionSet.h"
#include "volume/hbVolumeField.h"

namespace {

/// Uses the best set again in the end.
class Sets {
public:
  Sets() = default;
  Sets(const Sets&) = delete;
  Sets& operator=(const Sets&) = delete;
  ~Sets() { hb::useInstructionSet(""); }
  const std::vector<std::string> names = hb::instructionSets();
};

struct Points {
  std::vector<float> x, y, z;
  void add(float px, float py, float pz) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
  }
  hbPoints view() const { return {x, y, z}; }

  static Points random(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(-0.02F, 1.02F);
    Points p;
    for (std::size_t i = 0; i < count; ++i) p.add(unit(random), unit(random), unit(random));
    return p;
  }
  /// All triples of coordinates that are easily got wrong.
  static Points awkward() {
    const std::array list{0.0F,
                          1.0F,
                          0.5F,
                          1.0F / 3.0F,
                          0.99999994F,
                          1e-30F,
                          -0.0F,
                          -4.0F,
                          1.5F,
                          std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN()};
    Points p;
    for (const float z : list)
      for (const float y : list)
        for (const float x : list) p.add(x, y, z);
    return p;
  }
};

std::vector<float> valuesOf(const hbField& field, const Points& points, int component = 0) {
  std::vector<float> out(points.x.size());
  field.values(points.view(), component, out);
  return out;
}

/// Which of several NaN comes out is not said anywhere.
bool isSame(const std::vector<float>& a, const std::vector<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]) &&
        !(std::isnan(a[i]) && std::isnan(b[i])))
      return false;
  return a.size() == b.size();
}

/// The samples with as many others between them, which the kernel has no form for.
template <class T>
hbVolume apart(const hbGeometry& geometry, const std::vector<T>& samples) {
  std::vector<T> both(2 * samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) both[2 * i] = samples[i];
  return hbVolume::fromSamples(geometry, std::move(both), 2);
}

hbGeometry cubeOf(const hbSize3& size) {
  hbGeometry geometry;
  geometry.size = size;
  return geometry;
}

template <class T>
std::vector<T> randomSamples(const hbSize3& size) {
  std::mt19937 random(3);
  std::vector<T> samples(std::size_t(size.x * size.y * size.z));
  for (T& sample : samples)
    if constexpr (std::is_floating_point_v<T>)
      sample = std::uniform_real_distribution<T>(T(-100), T(100))(random);
    else
      sample = T(random());
  return samples;
}

template <class T>
bool agrees(const hbSize3& size, const std::vector<T>& samples, double slope, double intercept, const Points& points) {
  const Sets sets;
  const hbGeometry geometry = cubeOf(size);
  hbVolume volume = hbVolume::fromSamples(geometry, samples), reference = apart(geometry, samples);
  volume.setSlopeIntercept(slope, intercept);
  reference.setSlopeIntercept(slope, intercept);
  const std::vector<float> expected = valuesOf(hbVolumeField(reference, {}), points);
  for (const std::string& name : sets.names) {
    hb::useInstructionSet(name);
    if (!isSame(valuesOf(hbVolumeField(volume, {}), points), expected)) return false;
  }
  return true;
}

template <class T>
class hbTrilinearKernel : public ::testing::Test {};
using Types = ::testing::Types<float, std::int8_t, std::uint8_t, std::int16_t, std::uint16_t>;
TYPED_TEST_SUITE(hbTrilinearKernel, Types);

} // namespace

TYPED_TEST(hbTrilinearKernel, HasTheBitsOfTheValuesPointByPoint) {
  ASSERT_TRUE(hb::hasTrilinearKernel(hb::sampleTypeOf<TypeParam>()));
  for (const hbSize3& size : {hbSize3(17, 9, 13), hbSize3(2, 2, 2), hbSize3(2, 1, 1), hbSize3(40, 1, 3),
                              hbSize3(3, 5, 1), hbSize3(100, 2, 1)}) {
    const auto samples = randomSamples<TypeParam>(size);
    for (const Points& points : {Points::random(1003), Points::awkward(), Points::random(1)}) {
      EXPECT_TRUE(agrees(size, samples, 1.0, 0.0, points)) << size.x;
      EXPECT_TRUE(agrees(size, samples, 0.37, -1024.5, points)) << size.x;
    }
  }
}

TYPED_TEST(hbTrilinearKernel, FlatAlongXIsLeftToTheValuesPointByPoint) {
  const hbSize3 size(1, 5, 4);
  EXPECT_TRUE(agrees(size, randomSamples<TypeParam>(size), 1.0, 0.0, Points::awkward()));
}

TYPED_TEST(hbTrilinearKernel, ReadsNothingBehindTheLastSample) {
  // Samples that end where a page ends that may not be read.
  constexpr std::size_t kPage = 4096;
  const hbSize3 size(16, 16, std::int64_t(kPage / 256 / sizeof(TypeParam)));
  void* memory = mmap(nullptr, 2 * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  ASSERT_EQ(mprotect(static_cast<std::byte*>(memory) + kPage, kPage, PROT_NONE), 0);
  const std::shared_ptr<const std::byte> data(static_cast<const std::byte*>(memory),
                                              [memory](const std::byte*) { munmap(memory, 2 * kPage); });
  const hbVolumeField field(
      hbVolume(cubeOf(size), hb::sampleTypeOf<TypeParam>(), 1, data, hbVolume::Layout::packed(size, 1)));
  const Sets sets;
  for (const std::string& name : sets.names) {
    hb::useInstructionSet(name);
    for (const float value : valuesOf(field, Points::awkward())) ASSERT_EQ(value, 0.0F);
  }
}

TEST(hbTrilinearKernel, InfiniteSamplesAndNaNSpreadAsPointByPoint) {
  const hbSize3 size(5, 4, 3);
  auto samples = randomSamples<float>(size);
  samples[7] = std::numeric_limits<float>::quiet_NaN();
  samples[23] = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(agrees(size, samples, 1.0, 0.0, Points::random(2000)));
  EXPECT_TRUE(agrees(size, samples, 2.0, 1.0, Points::random(2000)));
}

TEST(hbTrilinearKernel, SamplesNeedNotBeAligned) {
  const hbSize3 size(7, 6, 5);
  const auto samples = randomSamples<float>(size);
  auto bytes = std::make_shared<std::vector<std::byte>>(samples.size() * sizeof(float) + 1);
  std::memcpy(bytes->data() + 1, samples.data(), samples.size() * sizeof(float));
  const hbVolumeField field(
      hbVolume(cubeOf(size), hbSampleType::float32, 1, {bytes, bytes->data() + 1}, hbVolume::Layout::packed(size, 1)));
  const Points points = Points::random(500);
  EXPECT_TRUE(isSame(valuesOf(field, points), valuesOf(hbVolumeField(apart(cubeOf(size), samples)), points)));
}

TEST(hbTrilinearKernel, ComponentsMayLieOneAfterTheOther) {
  // Two volumes in one: x side by side, so that the kernel reads both.
  const hbSize3 size(4, 3, 5);
  const auto samples = randomSamples<std::int16_t>({4, 3, 10});
  const auto data = std::make_shared<std::vector<std::int16_t>>(samples);
  const hbVolumeField field(hbVolume(cubeOf(size), hbSampleType::int16, 2,
                                     {data, reinterpret_cast<const std::byte*>(data->data())}, {{1, 4, 12}, 60}));
  const Points points = Points::random(500);
  const std::vector<std::int16_t> second(samples.begin() + 60, samples.end());
  EXPECT_TRUE(isSame(valuesOf(field, points, 1), valuesOf(hbVolumeField(apart(cubeOf(size), second)), points)));
}

TEST(hbTrilinearKernel, VolumesMayHaveMoreThan2To31Samples) {
  // Memory that nothing was written to costs nothing.
  const hbSize3 size(2049, 2049, 1025);
  const auto bytes = std::size_t(size.x * size.y * size.z);
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  const std::shared_ptr<std::byte> data(static_cast<std::byte*>(memory), [=](std::byte*) { munmap(memory, bytes); });
  data.get()[bytes - 1] = std::byte{200};
  const hbVolumeField field(hbVolume(cubeOf(size), hbSampleType::uint8, 1, data, hbVolume::Layout::packed(size, 1)),
                            {});
  const Sets sets;
  Points points;
  points.add(1.0F, 1.0F, 1.0F);
  points.add(1.0F - 0x1p-12F, 1.0F, 1.0F); // half-way to the last but one, 0
  for (const std::string& name : sets.names) {
    hb::useInstructionSet(name);
    EXPECT_EQ(valuesOf(field, points), (std::vector{200.0F, 100.0F})) << name;
  }
}

RC_GTEST_PROP(hbTrilinearKernel, AgreesForAllSizesValuesAndPoints, ()) {
  const hbSize3 size{*rc::gen::inRange(2, 12), *rc::gen::inRange(1, 9), *rc::gen::inRange(1, 9)};
  const auto samples = *rc::gen::container<std::vector<float>>(
      std::size_t(size.x * size.y * size.z),
      rc::gen::map(rc::gen::inRange(-100000, 100000), [](int v) { return float(v) / 7.0F; }));
  // Coordinates around all nodes: that is where the choice of a cell could go wrong.
  const auto coordinate = [](std::int64_t nodes) {
    return rc::gen::map(rc::gen::pair(rc::gen::inRange<std::int64_t>(0, nodes), rc::gen::inRange(-3, 4)),
                        [nodes](const auto& at) {
                          const float node = nodes > 1 ? float(at.first) / float(nodes - 1) : 0.5F;
                          return node + float(at.second) * 0x1p-24F;
                        });
  };
  Points points;
  const int count = *rc::gen::inRange(1, 40);
  for (int i = 0; i < count; ++i) points.add(*coordinate(size.x), *coordinate(size.y), *coordinate(size.z));
  RC_ASSERT(agrees(size, samples, *rc::gen::element(1.0, 0.5), *rc::gen::element(0.0, 3.25), points));
}
