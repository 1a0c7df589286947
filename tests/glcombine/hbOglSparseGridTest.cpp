#include "glcombine/hbOglSparseGrid.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "glcombine/hbFixedPointTarget.h"
#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlFunctions.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbGlTexture.h"
#include "tests/glcombine/hbGlBounds.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"

namespace {

using Form = hbTextureLayout::Form;

hbCombinationSparseGrid gridOf(const char* field, const hbIndexSet& set) {
  return hbCombinationSparseGrid(hbSparseGrid::interpolate(
      *hbAnalyticField::create(field)->withSize(hbTestSets::sizeOf(set)), set, hbLatticeMapping::fitted));
}

constexpr int kWidth = 37, kHeight = 23;

/// An oblique plane that leaves the cube at some corners.
hbOglSparseGrid::Plane oblique() {
  return {{-0.05, 0.1, 0.2}, {0.9 / kWidth, 0.3 / kWidth, 0.1 / kWidth}, {0.2 / kHeight, 0.7 / kHeight, 0.5 / kHeight}};
}

/// The field values that are drawn on a plane.
std::vector<float> drawnValues(const hbGlContext& context, const hbOglSparseGrid& grid, hbGlFormat format,
                               const hbOglSparseGrid::Plane& plane) {
  const hbGlTarget target(context.gl(), kWidth, kHeight, format);
  const std::array<const hbGlTarget*, 1> targets{&target};
  grid.draw({&plane, 1}, targets);
  std::vector<float> out;
  target.read(out);
  for (float& value : out) value = float(grid.valueOf(double(value)));
  return out;
}

glm::dvec3 sample(const hbOglSparseGrid::Plane& plane, int x, int y) {
  return plane.corner + (x + 0.5) * plane.right + (y + 0.5) * plane.down;
}

/// Neither in nor out for rounding.
bool isInside(const glm::dvec3& p) {
  for (int d = 0; d < 3; ++d)
    if (!(p[d] > 1e-6 && p[d] < 1.0 - 1e-6)) return false;
  return true;
}

/// One component grid's value, in 64 bits.
double trilinear(const hbCombinationSparseGrid& grid, const hbCombinationSparseGrid::Grid& one, const glm::dvec3& p) {
  const auto values = grid.values(one, 0);
  std::array<std::int64_t, 3> cell{};
  std::array<double, 3> t{};
  for (int d = 0; d < 3; ++d) {
    const double place = p[d] * double(one.nodes[d] - 1);
    cell[std::size_t(d)] = std::min(std::int64_t(place), std::max<std::int64_t>(one.nodes[d] - 2, 0));
    t[std::size_t(d)] = place - double(cell[std::size_t(d)]);
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::int64_t index = 0, stride = 1;
    for (int d = 0; d < 3; ++d) {
      const int up = corner >> d & 1;
      weight *= up ? t[std::size_t(d)] : 1.0 - t[std::size_t(d)];
      index += stride * std::min(cell[std::size_t(d)] + up, one.nodes[d] - 1);
      stride *= one.nodes[d];
    }
    sum += weight * values[std::size_t(index)];
  }
  return sum;
}

} // namespace

TEST(hbOglSparseGrid, FloatsAreTheCombinationUpToRounding) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbIndexSet sets[] = {hbIndexSet::regular(5, {}), hbIndexSet::regular(3, {{20, 20, 0}, {false, false, true}}),
                             hbIndexSet::regular(4, {{2, 20, 0}, {false, false, false}})};
  for (const hbIndexSet& set : sets)
    for (const Form form : {Form::exact, Form::padded}) {
      const hbCombinationSparseGrid grid = gridOf("vortex", set);
      const hbOglSparseGrid drawn(*context, grid, 0, {hbGlFormat::r32f, hbGlFormat::r32f, form});
      const hbOglSparseGrid::Plane plane = oblique();
      const std::vector<float> out = drawnValues(*context, drawn, hbGlFormat::r32f, plane);
      ASSERT_EQ(out.size(), std::size_t(kWidth * kHeight));
      const double tolerance = hbGlBounds(grid).floats();
      int inside = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const glm::dvec3 p = sample(plane, x, y);
          const float value = out[std::size_t(x + kWidth * y)];
          if (isInside(p)) {
            ++inside;
            const std::array<double, 3> at{p.x, p.y, p.z};
            double exact = 0.0;
            grid.values(hbPoints64{{&at[0], 1}, {&at[1], 1}, {&at[2], 1}}, 0, {&exact, 1});
            EXPECT_NEAR(value, exact, tolerance) << x << " " << y;
          } else {
            EXPECT_TRUE(std::isfinite(value)) << x << " " << y;
          }
        }
      EXPECT_GT(inside, 200);
      EXPECT_LT(inside, kWidth * kHeight);
    }
}

// Where a real target rounds is its own: what is drawn, before it is blended, or only the result. Either is up to half
// a step, so real and emulated targets drift apart by a step a blend at the most, and clamping brings them no farther
// apart.
TEST(hbOglSparseGrid, FixedPointTargetsLoseWhatTheEmulatorSays) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbCombinationSparseGrid grid = gridOf("hydrogen", hbIndexSet::regular(5, {}));
  float least = 0.0F, greatest = 0.0F;
  double positive = 0.0;
  for (const auto& one : grid.grids()) {
    for (const float value : grid.values(one, 0)) {
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
    positive += std::max(one.coefficient, 0);
  }
  for (const auto& [format, bits] : {std::pair(hbGlFormat::r8, 8), {hbGlFormat::r16, 16}}) {
    const hbOglSparseGrid drawn(*context, grid, 0, {hbGlFormat::r32f, format, Form::exact});
    const hbOglSparseGrid::Plane plane = oblique();
    const std::vector<float> out = drawnValues(*context, drawn, format, plane);
    const double step = 2.0 * hbFixedPointTarget(bits).halfStep() * (greatest - least) * positive;
    double worst = 0.0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const glm::dvec3 p = sample(plane, x, y);
        if (!isInside(p)) continue;
        hbFixedPointTarget target(bits);
        for (const bool isPositive : {true, false})
          for (const auto& one : grid.grids()) {
            if ((one.coefficient > 0) != isPositive) continue;
            const double value =
                std::abs(one.coefficient) * (trilinear(grid, one, p) - least) / ((double(greatest) - least) * positive);
            isPositive ? target.add(value) : target.reverseSubtract(value);
          }
        const double expected = least + target.value() * (double(greatest) - least) * positive;
        worst = std::max(worst, std::abs(out[std::size_t(x + kWidth * y)] - expected));
      }
    EXPECT_LE(worst, double(grid.grids().size()) * step) << bits;
    EXPECT_GT(worst, 0.0) << bits; // 8 bits of a positive sum of 21 are not exact
  }
}

TEST(hbOglSparseGrid, TextureBytesAreThoseOfTheTable) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbIndexSet set = hbIndexSet::regular(5, {});
  const hbCombinationSparseGrid grid = gridOf("smooth", set);
  for (const auto& [format, bytes] :
       {std::pair(hbGlFormat::r8, 1), {hbGlFormat::r16, 2}, {hbGlFormat::r16f, 2}, {hbGlFormat::r32f, 4}}) {
    EXPECT_EQ(hbOglSparseGrid(*context, grid, 0, {format, format, Form::padded}).textureBytes(), 22016 * bytes);
    EXPECT_EQ(hbOglSparseGrid(*context, grid, 0, {format, format, Form::exact}).textureBytes(), 5687 * bytes);
  }
}

TEST(hbOglSparseGrid, LeavesNoTexturesBehind) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbCombinationSparseGrid grid = gridOf("smooth", hbIndexSet::regular(4, {}));
  const auto alive = [&] {
    int count = 0;
    for (GLuint name = 1; name < 1000; ++name) count += context->gl().IsTexture(name) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(alive(), 0);
  for (int round = 0; round < 3; ++round) {
    const hbOglSparseGrid drawn(*context, grid, 0, {});
    drawnValues(*context, drawn, hbGlFormat::r32f, oblique());
    EXPECT_EQ(alive(), drawn.textures());
  }
  EXPECT_EQ(alive(), 0);
}
