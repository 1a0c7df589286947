#include "raycast/hbSceneDefaults.h"

#include <gtest/gtest.h>

#include "volume/fields/hbAnalyticField.h"
#include "volume/hbError.h"
#include "volume/hbVolumeField.h"

TEST(hbSceneDefaults, TheHistogramSeesTheField) {
  const auto ball = hbAnalyticField::create("ball,radius=0.25");
  const hbHistogram h = hb::fieldHistogram(*ball, 0);
  EXPECT_EQ(h.count, 64 * 64 * 64);
  // The ball's share of the cube; a lattice of cells 1/64 counts its volume to within its surface times half a cell.
  const double volume = 4.0 / 3.0 * 3.14159265 * 0.25 * 0.25 * 0.25, surface = 4.0 * 3.14159265 * 0.25 * 0.25;
  EXPECT_NEAR(h.mean, volume, surface / 128.0);
  EXPECT_GT(h.otsuThreshold(), 0.0);
  EXPECT_LT(h.otsuThreshold(), 1.0);
}

TEST(hbSceneDefaults, SmallAndFlatFieldsAreSampledAtTheirOwnSize) {
  EXPECT_EQ(hb::fieldHistogram(*hbAnalyticField::create("smooth,size=5x3x1"), 0).count, 15);
}

TEST(hbSceneDefaults, AnOffsetMovesTheThresholdAndNothingElse) {
  // The same signal with and without 1e9 on top: a float of the sum would have no digits left for the signal.
  hbGeometry geometry;
  geometry.size = {9, 9, 9};
  std::vector<double> plain, offset;
  for (int i = 0; i < 729; ++i) {
    plain.push_back(0.125 * (i * 7919 % 64));
    offset.push_back(1e9 + plain.back());
  }
  const hbHistogram a = hb::fieldHistogram(hbVolumeField(hbVolume::fromSamples(geometry, plain)), 0);
  const hbHistogram b = hb::fieldHistogram(hbVolumeField(hbVolume::fromSamples(geometry, offset)), 0);
  EXPECT_EQ(a.bins, b.bins);
  // 1e9 has 2^-23 for its last place in 64 bits.
  EXPECT_NEAR(b.otsuThreshold() - 1e9, a.otsuThreshold(), 1e-6);
  EXPECT_NEAR(b.min - 1e9, a.min, 1e-6);
  EXPECT_NEAR(b.percentile(0.5) - 1e9, a.percentile(0.5), 1e-6);
}

namespace {

hbHistogram histogramOf(std::vector<float> values) { return hb::calcHistogram(values); }

} // namespace

TEST(hbSceneDefaults, OutliersDoNotDetermineTheShownRange) {
  std::vector<float> values;
  for (int i = 0; i < 100000; ++i) values.push_back(float(i % 1000));
  values.push_back(1e6F);
  const auto [lo, hi] = hb::shownRange(histogramOf(values));
  EXPECT_GE(lo, 0.0);
  EXPECT_NEAR(hi, 1000.0, 100.0); // to within the percentiles' steps of 1e6 / 65536
  const auto [all, one] = hb::shownRange(histogramOf({3.0F, 3.0F, 3.0F, 3.0F, 7.0F}));
  EXPECT_NEAR(all, 3.0, 4.0 / 256.0); // the bin of the most
  EXPECT_EQ(one, 7.0);
}

TEST(hbSceneDefaults, TheEmptinessAroundThingsIsWhereTheShownRangeBegins) {
  std::vector<float> values(9000, 0.0F);
  for (int i = 0; i < 1000; ++i) values.push_back(float(i) / 1000.0F - 0.05F);
  const auto [lo, hi] = hb::shownRange(histogramOf(values));
  EXPECT_NEAR(lo, 0.0, 1.0 / 256.0); // a bin
  EXPECT_NEAR(hi, 0.93, 0.03);
}

TEST(hbSceneDefaults, TransferFunctionsAreStretchedAndGetAUnit) {
  hbGeometry geometry;
  geometry.size = {5, 5, 9};
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(float(i) - 100.0F);
  const hbHistogram histogram = histogramOf(values);
  const hbTransferFunction chosen = hb::transferFor({}, histogram, geometry);
  EXPECT_EQ(chosen.name(), "density");
  EXPECT_FALSE(chosen.definition().relative);
  EXPECT_EQ(chosen.range(), hb::shownRange(histogram));
  EXPECT_EQ(chosen.definition().unitLength, hbTransferFunction::defaultUnitLength(geometry));
  const auto [lo, hi] = hb::transferFor(hbTransferFunction::preset("simulation"), histogram, geometry).range();
  EXPECT_EQ(lo, -hi);
  EXPECT_EQ(hi, hb::shownRange(histogram).second);
  // Values from about 0 on go one way from the middle.
  for (const float sign : {1.0F, -1.0F}) {
    std::vector<float> oneSided;
    for (int i = 0; i <= 1000; ++i) oneSided.push_back(sign * float(i));
    const auto range =
        hb::transferFor(hbTransferFunction::preset("simulation"), histogramOf(oneSided), geometry).range();
    EXPECT_EQ(range.first, -range.second);
    EXPECT_GT(range.second, 900.0);
    for (float& value : oneSided) value += sign * 1000.0F;
    const auto far = hb::transferFor(hbTransferFunction::preset("simulation"), histogramOf(oneSided), geometry).range();
    EXPECT_GT(far.first * far.second, 0.0);
  }
  // What says its own range and unit keeps them.
  const hbTransferFunction own = hbTransferFunction::preset("ct-bone").withUnitLength(3.0);
  EXPECT_EQ(hb::transferFor(own, histogram, geometry), own);
  EXPECT_THROW(hb::transferFor({}, histogramOf({2.0F, 2.0F}), geometry), hbError);
}
