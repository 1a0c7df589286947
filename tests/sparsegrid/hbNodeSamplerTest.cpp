#include "sparsegrid/hbNodeSampler.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "sparsegrid/hbHierarchise.h"
#include "sparsegrid/hbSparseGrid.h"
#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

namespace {

/// Counts what is read of a field.
class CountingField final : public hbField {
public:
  explicit CountingField(std::shared_ptr<const hbField> field) : field_(std::move(field)) {}
  std::int64_t count() const { return count_; }
  /// The least and greatest z of the lattices since the last time.
  std::pair<double, double> planesReadSince() const {
    const std::lock_guard lock(mutex_);
    return std::exchange(planes_, kNoPlanes);
  }

  const hbGeometry& geometry() const override { return field_->geometry(); }
  int components() const override { return field_->components(); }
  void values(const hbPoints& points, int component, std::span<float> out) const override {
    count_ += std::int64_t(points.size());
    field_->values(points, component, out);
  }
  void gradients(const hbPoints& points, int component, std::span<float> out,
                 const hbGradients& gradient) const override {
    count_ += std::int64_t(points.size());
    field_->gradients(points, component, out, gradient);
  }
  void lattice(std::span<const double> xs, std::span<const double> ys, std::span<const double> zs, int component,
               float* out, std::size_t strideY, std::size_t strideZ) const override {
    count_ += std::int64_t(xs.size() * ys.size() * zs.size());
    {
      const std::lock_guard lock(mutex_);
      planes_ = {std::min(planes_.first, zs.front()), std::max(planes_.second, zs.back())};
    }
    field_->lattice(xs, ys, zs, component, out, strideY, strideZ);
  }
  hbRange range(const hbBox& box, int component) const override { return field_->range(box, component); }

private:
  std::shared_ptr<const hbField> field_;
  mutable std::atomic<std::int64_t> count_{0};
  static constexpr std::pair<double, double> kNoPlanes{2.0, -1.0};
  mutable std::mutex mutex_;
  mutable std::pair<double, double> planes_ = kNoPlanes;
};

hbGeometry cubeOf(const hbSize3& size) {
  hbGeometry g;
  g.size = size;
  return g;
}

} // namespace

TEST(hbNodeSampler, FittedReadsEachNodeOnce) {
  const CountingField field(hbAnalyticField::create("smooth,size=200"));
  const hbIndexSet set = hbIndexSet::regular(6, hbIndexSet::axesOf(field.geometry().size));
  hbSparseGrid::interpolate(field, set, hbLatticeMapping::fitted);
  EXPECT_EQ(field.count(), set.storedValues());
}

// An aligned axis of N samples keeps N surpluses that are not zero, however many nodes the lattice has; in three
// dimensions the product. Integer samples, so that what should vanish does (rounding below 1e-9 here).
RC_GTEST_PROP(hbNodeSampler, AlignedContinuationKeepsAsManySurplusesAsSamples, ()) {
  const auto axis = rc::gen::inRange(1, 20);
  const hbSize3 size{*axis, *axis, *axis};
  const auto samples = *rc::gen::container<std::vector<std::uint8_t>>(std::size_t(size.x * size.y * size.z),
                                                                      rc::gen::arbitrary<std::uint8_t>());
  const hbVolumeField field(hbVolume::fromSamples(cubeOf(size), samples));
  const hbIndexSet set = hbIndexSet::full(hbIndexSet::axesOf(size));
  const hbSparseGrid grid = hbSparseGrid::interpolate(field, set, hbLatticeMapping::aligned);
  std::int64_t kept = 0;
  for (const float s : grid.surpluses(0)) kept += std::abs(s) > 1e-9F ? 1 : 0;
  RC_ASSERT(kept <= size.x * size.y * size.z);
}

TEST(hbNodeSampler, RefusesSamplesThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<float> samples(125, 1.0F);
    samples[62] = bad;
    const hbVolume volume = hbVolume::fromSamples(cubeOf({5, 5, 5}), samples);
    const hbIndexSet set = hbIndexSet::regular(3, hbIndexSet::axesOf({5, 5, 5}));
    for (const auto mapping : {hbLatticeMapping::fitted, hbLatticeMapping::aligned}) {
      EXPECT_THROW(hbSparseGrid::interpolate(hbVolumeField(volume), set, mapping), hbError);
      const hbVolumeField replaced(volume, {}, 7.0);
      EXPECT_EQ(hbSparseGrid::interpolate(replaced, set, mapping).calcValue({0.5, 0.5, 0.5}, 0), 7.0);
    }
  }
}

TEST(hbNodeSampler, RefusesSetsThatCannotBeAligned) {
  const auto field = hbAnalyticField::create("smooth,size=17");
  const hbIndexSet fine = hbIndexSet::regular(6, {});
  EXPECT_THROW(hbSparseGrid::interpolate(*field, fine, hbLatticeMapping::aligned), hbError);
  EXPECT_NO_THROW(hbSparseGrid::interpolate(*field, fine, hbLatticeMapping::fitted));
  // 2^20 + 2 samples need level 21.
  const hbIndexSet line = hbIndexSet::regular(3, hbIndexSet::axesOf({9, 1, 1}));
  EXPECT_THROW(hbNodeSampler::checkAligned({(1 << 20) + 2, 1, 1}, line), hbError);
  EXPECT_NO_THROW(hbNodeSampler::checkAligned({(1 << 20) + 1, 1, 1}, line));
  for (const auto& [size, level] : {std::pair{1, 0}, {2, 0}, {3, 1}, {4, 2}, {5, 2}, {6, 3}, {257, 8}, {258, 9}})
    EXPECT_EQ(hbNodeSampler::alignedLevel(size), level) << size;
}

namespace {

/// Samples continued to the 2^n + 1 nodes of an aligned axis, as hbNodeSampler describes it, node by node from coarse
/// to fine. Exact for small integers: dyadic weights.
std::vector<double> continued(std::vector<double> samples) {
  const std::int64_t size = std::int64_t(samples.size()), end = std::int64_t{1} << hbNodeSampler::alignedLevel(size);
  if (size == 1) return samples;
  samples.resize(std::size_t(end) + 1);
  if (size <= end) samples[std::size_t(end)] = 2.0 * samples[std::size_t(end / 2)] - samples[0];
  for (std::int64_t distance = end / 2; distance > 0; distance /= 2)
    for (std::int64_t i = distance; i < end; i += 2 * distance)
      if (i >= size)
        samples[std::size_t(i)] = 0.5 * (samples[std::size_t(i - distance)] + samples[std::size_t(i + distance)]);
  return samples;
}

/// All nodes of the finest aligned lattice, x fastest; `size` becomes their number.
std::vector<double> continued(std::vector<double> values, hbSize3& size) {
  for (int d = 0; d < 3; ++d) {
    hbSize3 next = size;
    next[d] = size[d] == 1 ? 1 : (std::int64_t{1} << hbNodeSampler::alignedLevel(size[d])) + 1;
    std::vector<double> result(std::size_t(next.x * next.y * next.z));
    const std::int64_t inner = d == 0 ? 1 : d == 1 ? size.x : size.x * size.y;
    for (std::int64_t line = 0; line < std::int64_t(values.size()) / size[d]; ++line) {
      const std::int64_t in = line % inner, out = line / inner;
      std::vector<double> along;
      for (std::int64_t i = 0; i < size[d]; ++i) along.push_back(values[std::size_t((out * size[d] + i) * inner + in)]);
      along = continued(along);
      for (std::int64_t i = 0; i < next[d]; ++i)
        result[std::size_t((out * next[d] + i) * inner + in)] = along[std::size_t(i)];
    }
    values = std::move(result);
    size = next;
  }
  return values;
}

/// Node k of a level, on a lattice of `cells`.
std::int64_t placeOf(int level, std::int64_t k, std::int64_t cells) {
  return level == 0 ? k * cells : (2 * k + 1) * (cells >> level);
}

} // namespace

RC_GTEST_PROP(hbNodeSampler, ReadsWhatEachSubspaceHasByItself, ()) {
  const auto axis = rc::gen::inRange(1, 20);
  const hbSize3 size{*axis, *axis, *axis};
  const int components = *rc::gen::inRange(1, 3);
  const auto samples = *rc::gen::container<std::vector<std::uint8_t>>(
      std::size_t(size.x * size.y * size.z) * std::size_t(components), rc::gen::arbitrary<std::uint8_t>());
  const hbVolume volume = hbVolume::fromSamples(cubeOf(size), samples, components);
  const hbVolumeField field(volume);
  const bool aligned = *rc::gen::arbitrary<bool>();
  hbIndexSet::Axes axes = hbIndexSet::axesOf(size);
  for (int d = 0; d < 3; ++d) axes.maxLevel[d] = *rc::gen::inRange(0, axes.maxLevel[d] + 1);
  const hbIndexSet set = *rc::gen::arbitrary<bool>() ? hbIndexSet::full(axes) : hbIndexSet::regular(3, axes);

  const auto found = hbNodeSampler(field, set, aligned ? hbLatticeMapping::aligned : hbLatticeMapping::fitted)
                         .sample(hbProgress::none());
  RC_ASSERT(int(found.size()) == components);
  for (int c = 0; c < components; ++c) {
    RC_ASSERT(std::int64_t(found[std::size_t(c)].size()) == set.storedValues());
    hbSize3 nodes = size;
    std::vector<double> lattice;
    for (std::size_t i = std::size_t(c); i < samples.size(); i += std::size_t(components))
      lattice.push_back(double(samples[i]));
    lattice = continued(lattice, nodes);
    for (const hbSubspace& subspace : set.subspaces()) {
      std::array<std::vector<double>, 3> at;
      for (int d = 0; d < 3; ++d)
        for (std::int64_t k = 0; k < subspace.nodes[d]; ++k)
          at[std::size_t(d)].push_back(size[d] == 1 ? 0.5
                                                    : std::ldexp(double(placeOf(subspace.levels[d], k, 1 << 20)), -20));
      std::vector<float> fitted(std::size_t(subspace.count()));
      field.lattice(at[0], at[1], at[2], c, fitted.data(), at[0].size(), at[0].size() * at[1].size());
      std::int64_t i = 0;
      for (std::int64_t z = 0; z < subspace.nodes.z; ++z)
        for (std::int64_t y = 0; y < subspace.nodes.y; ++y)
          for (std::int64_t x = 0; x < subspace.nodes.x; ++x, ++i) {
            const hbSize3 k{x, y, z};
            hbSize3 place;
            for (int d = 0; d < 3; ++d) place[d] = nodes[d] == 1 ? 0 : placeOf(subspace.levels[d], k[d], nodes[d] - 1);
            const double expected = aligned ? lattice[std::size_t(place.x + nodes.x * (place.y + nodes.y * place.z))]
                                            : double(fitted[std::size_t(i)]);
            RC_ASSERT(found[std::size_t(c)][std::size_t(subspace.offset + i)] == expected);
          }
    }
  }
}

TEST(hbNodeSampler, ReadsBandsOfPlanesFromFrontToBack) {
  // Planes of 2049^2 samples, of which a band takes three: 2^24 / 2049^2 = 3.996. Aligned, half of the lattice of
  // 2048 cells is outside and is not read at all.
  for (const auto& [depth, mapping] : {std::pair{2049, hbLatticeMapping::fitted},
                                       {2049, hbLatticeMapping::aligned},
                                       {1026, hbLatticeMapping::aligned},
                                       {700, hbLatticeMapping::fitted}}) {
    const CountingField field(hbAnalyticField::create("smooth")->withSize({2049, 2049, depth}));
    const hbIndexSet set = hbIndexSet::regular(11, hbIndexSet::axesOf(field.geometry().size));
    std::int64_t bands = 0, before = 0;
    const auto values = hbNodeSampler(field, set, mapping).sample(hbProgress::none(), [&](auto first, auto last) {
      const auto [least, greatest] = field.planesReadSince();
      // The places read lie between the two samples; i/(N-1) times N-1 may miss i by an ulp of it.
      EXPECT_GE(least * (depth - 1), double(first) - depth * 0x1p-52);
      EXPECT_LE(greatest * (depth - 1), double(last) + depth * 0x1p-52);
      EXPECT_GE(first, before - 1);
      EXPECT_LE(last - first, 2);
      before = last;
      ++bands;
    });
    EXPECT_EQ(before, depth - 1);
    EXPECT_GE(bands, depth / 3);
    std::int64_t inside = 0;
    for (const hbSubspace& subspace : set.subspaces())
      for (std::int64_t k = 0; k < subspace.nodes.z; ++k) {
        const bool read = mapping == hbLatticeMapping::fitted ||
                          placeOf(subspace.levels.z, k, 1 << hbNodeSampler::alignedLevel(depth)) < depth;
        inside += read ? subspace.nodes.x * subspace.nodes.y : 0;
      }
    EXPECT_EQ(field.count(), inside);
  }
}
