#include "sparsegrid/hbNodeSampler.h"

#include <atomic>
#include <cmath>
#include <limits>

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
    field_->lattice(xs, ys, zs, component, out, strideY, strideZ);
  }
  hbRange range(const hbBox& box, int component) const override { return field_->range(box, component); }

private:
  std::shared_ptr<const hbField> field_;
  mutable std::atomic<std::int64_t> count_{0};
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

TEST(hbNodeSampler, SlabsAreThePlanesOfTheWhole) {
  const auto field = hbAnalyticField::create("vortex,size=11x7x14");
  for (const auto mapping : {hbLatticeMapping::fitted, hbLatticeMapping::aligned}) {
    const hbIndexSet set = hbIndexSet::full(hbIndexSet::axesOf(field->geometry().size));
    const hbNodeSampler sampler(*field, set, mapping);
    const hbSubspace& subspace = set.subspace(set.finest());
    std::vector<double> whole(std::size_t(subspace.count())), slab;
    sampler.sample(subspace, 0, subspace.nodes.z, 0, whole);
    const std::int64_t plane = subspace.nodes.x * subspace.nodes.y;
    slab.resize(std::size_t(3 * plane));
    sampler.sample(subspace, 2, 3, 0, slab);
    EXPECT_TRUE(std::equal(slab.begin(), slab.end(), whole.begin() + 2 * plane));
  }
}
