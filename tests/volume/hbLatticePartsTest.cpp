#include "volume/hbLatticeParts.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "volume/fields/hbAnalyticField.h"

namespace {

std::vector<double> places(std::int64_t count) {
  std::vector<double> list;
  for (std::int64_t i = 0; i < count; ++i) list.push_back((double(i) + 0.25) / double(count));
  return list;
}

hbLatticeParts partsOf(const hbSize3& size) { return {places(size.x), places(size.y), places(size.z)}; }

} // namespace

RC_GTEST_PROP(hbLatticeParts, MakeUpTheLatticePartAfterPart, ()) {
  const auto axis = rc::gen::inRange(1, 40);
  const hbSize3 size{*axis, *axis, *axis};
  const std::int64_t most = *rc::gen::inRange(1, 3000);
  const hbLatticeParts parts(places(size.x), places(size.y), places(size.z), most);
  RC_ASSERT(parts.size() == size);
  const auto field = hbAnalyticField::create("vortex");
  const auto xs = places(size.x), ys = places(size.y), zs = places(size.z);
  std::vector<float> whole(std::size_t(size.x * size.y * size.z)), pieces;
  field->lattice(xs, ys, zs, 0, whole.data(), xs.size(), xs.size() * ys.size());
  for (std::int64_t i = 0; i < parts.count(); ++i) {
    const hbLatticeParts::Part part = parts.part(i);
    RC_ASSERT(parts.samplesBefore(part) == std::int64_t(pieces.size()));
    RC_ASSERT(parts.samples(part) <= std::max(most, size.x));
    RC_ASSERT(part.planes == 1 || part.rows == size.y);
    pieces.resize(pieces.size() + std::size_t(parts.samples(part)));
    parts.evaluate(*field, 0, part, pieces.data() + parts.samplesBefore(part));
  }
  RC_ASSERT(pieces == whole);
}

TEST(hbLatticeParts, ArePlanesUnlessThoseAreLargeOrFew) {
  const auto first = [](const hbSize3& size) { return partsOf(size).part(0); };
  EXPECT_EQ(first({1025, 1025, 1025}).rows, 1025);
  EXPECT_EQ(first({1025, 1025, 1025}).planes, 1);
  EXPECT_EQ(first({129, 129, 129}).planes, 65536 / (129 * 129));
  EXPECT_EQ(first({9, 9, 9}).planes, 9);
  EXPECT_EQ(first({2049, 2049, 2049}).rows, 683);  // a third of 4.2 million samples
  EXPECT_EQ(partsOf({1000, 1000, 1}).count(), 15); // of 65536 samples at least
  EXPECT_EQ(partsOf({300, 300, 1}).count(), 1);
  EXPECT_EQ(partsOf({3000000, 2, 1}).count(), 2); // a row at least
}
