#include "volume/hbOutlierField.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "volume/fields/hbAnalyticField.h"

namespace {

struct Lattice {
  std::vector<double> places;
  std::vector<float> values;

  Lattice(const hbField& field, int count) : values(std::size_t(count * count * count)) {
    for (int i = 0; i < count; ++i) places.push_back(double(i) / double(count - 1));
    field.lattice(places, places, places, 0, values.data(), std::size_t(count), std::size_t(count * count));
  }
};

std::shared_ptr<const hbField> smooth(std::int64_t count) {
  return hbAnalyticField::create("smooth")->withSize(hbSize3(count));
}

} // namespace

// Of 27,000 samples 5 % with a deviation of 0.13 %; their values' mean is the middle of the range, with a deviation of
// the range / sqrt(12 * 1350). Five deviations are allowed, and one spoiled value may be near the true one.
TEST(hbOutlierField, SpoilsAShareOfTheSamplesUniformly) {
  constexpr int kCount = 30;
  const auto source = smooth(kCount);
  const hbOutlierField field(source, 0.05);
  const Lattice clean(*source, kCount), spoiled(field, kCount);
  const hbRange range = source->range({}, 0);
  double count = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < clean.values.size(); ++i) {
    EXPECT_TRUE(spoiled.values[i] >= range.lo && spoiled.values[i] <= range.hi);
    if (spoiled.values[i] == clean.values[i]) continue;
    count += 1.0;
    sum += double(spoiled.values[i]);
  }
  EXPECT_NEAR(count / 27000.0, 0.05, 5.0 * 0.0014);
  const double width = double(range.hi) - double(range.lo);
  EXPECT_NEAR(sum / count, 0.5 * (double(range.lo) + double(range.hi)), 5.0 * width / std::sqrt(12.0 * count));
}

TEST(hbOutlierField, NoneAndAllAreTheLimits) {
  const auto source = smooth(9);
  EXPECT_EQ(Lattice(hbOutlierField(source, 0.0), 9).values, Lattice(*source, 9).values);
  const Lattice all(hbOutlierField(source, 1.0), 9), clean(*source, 9);
  for (std::size_t i = 0; i < clean.values.size(); ++i) EXPECT_NE(all.values[i], clean.values[i]);
}

// Single points, lattices and gradients see the same ones; a point belongs to the nearest sample.
TEST(hbOutlierField, IsTheSameEverywhere) {
  const auto source = smooth(9);
  const hbOutlierField field(source, 0.3);
  const Lattice lattice(field, 9), clean(*source, 9);
  std::vector<float> x, y, z;
  for (int k = 0; k < 9; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i) {
        x.push_back(float(i) / 8.0F);
        y.push_back(float(j) / 8.0F);
        z.push_back(float(k) / 8.0F);
      }
  std::vector<float> values(x.size()), again(x.size()), dx(x.size()), dy(x.size()), dz(x.size());
  field.values({x, y, z}, 0, values);
  field.gradients({x, y, z}, 0, again, {dx, dy, dz});
  EXPECT_EQ(values, lattice.values);
  EXPECT_EQ(again, values);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i] != clean.values[i], dx[i] == 0.0F);
  for (float& c : x) c = std::min(1.0F, c + 0.05F);
  field.values({x, y, z}, 0, again);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != clean.values[i]) {
      EXPECT_EQ(again[i], values[i]);
    }
  }
}
