#include "glcombine/hbOglSparseGrid.h"

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "glcombine/hbFixedPointTarget.h"
#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlFunctions.h"
#include "glcombine/hbGlTarget.h"
#include "glcombine/hbGlTexture.h"
#include "glcombine/hbOglPointBounds.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "glcombine/hbOglTiles.h"
#include "glcombine/hbTermOrder.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbTestScenes.h"
#include "tests/sparsegrid/hbTestCombinations.h"
#include "tests/sparsegrid/hbTestSets.h"
#include "volume/fields/hbAnalyticField.h"

namespace {

using Form = hbTextureLayout::Form;
using Order = hbOglSparseGrid::Order;
using Filter = hbOglSparseGrid::Filter;

hbCombinationSparseGrid gridOf(const char* field, const hbIndexSet& set) {
  return hbCombinationSparseGrid(hbSparseGrid::interpolate(
      *hbAnalyticField::create(field)->withSize(hbTestSets::sizeOf(set)), set, hbLatticeMapping::fitted));
}

/// Of a volume whose samples end within the lattice.
hbCombinationSparseGrid alignedGrid() {
  const hbSize3 size(21, 14, 9);
  return hbCombinationSparseGrid(hbSparseGrid::interpolate(*hbAnalyticField::create("vortex")->withSize(size),
                                                           hbIndexSet::regular(4, hbIndexSet::axesOf(size)),
                                                           hbLatticeMapping::aligned));
}

constexpr int kWidth = 37, kHeight = 23;

/// An oblique plane that leaves the cube at some corners.
hbOglSparseGrid::Plane oblique() {
  return {{-0.05, 0.1, 0.2},
          {0.9 / kWidth, 0.3 / kWidth, 0.1 / kWidth},
          {0.2 / kHeight, 0.7 / kHeight, 0.5 / kHeight},
          {0, 0, kWidth, kHeight}};
}

/// The field values that are drawn on a plane.
std::vector<float> drawnValues(const hbGlContext& context, const hbOglSparseGrid& grid, hbGlFormat format,
                               const hbOglSparseGrid::Plane& plane) {
  const hbGlTarget target(context.gl(), kWidth, kHeight, format);
  grid.draw({&plane, 1}, hbOglTiles(kWidth, kHeight, 1, 16384), target);
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

double exactValue(const hbCombinationSparseGrid& grid, const glm::dvec3& p) {
  double exact = 0.0;
  grid.values(hbPoints64{{&p.x, 1}, {&p.y, 1}, {&p.z, 1}}, 0, {&exact, 1});
  return exact;
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
                             hbIndexSet::regular(4, {{2, 20, 0}, {false, false, false}}),
                             hbIndexSet::anisotropic({5, 2, 3}, {}), hbTestSets::uneven(),
                             // 2049 nodes, one more than Mesa's software renderer has texels along an axis.
                             hbIndexSet::regular(11, {{20, 0, 0}, {false, false, false}})};
  std::vector<hbCombinationSparseGrid> grids{alignedGrid()};
  for (const hbIndexSet& set : sets) grids.push_back(gridOf("vortex", set));
  for (const hbCombinationSparseGrid& grid : grids)
    for (const auto& [form, order, filter] : {std::tuple(Form::exact, Order::interleaved, Filter::hardware),
                                              {Form::padded, Order::interleaved, Filter::exact},
                                              {Form::exact, Order::positiveFirst, Filter::exact},
                                              {Form::padded, Order::positiveFirst, Filter::hardware}}) {
      const hbOglSparseGrid drawn(*context, grid, 0, {hbGlFormat::r32f, hbGlFormat::r32f, form, order, filter});
      const hbOglSparseGrid::Plane plane = oblique();
      const std::vector<float> out = drawnValues(*context, drawn, hbGlFormat::r32f, plane);
      ASSERT_EQ(out.size(), std::size_t(kWidth * kHeight));
      const double tolerance = hbOglRoundingBounds(grid).floats();
      int inside = 0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const glm::dvec3 p = sample(plane, x, y);
          const float value = out[std::size_t(x + kWidth * y)];
          if (isInside(p)) {
            ++inside;
            EXPECT_NEAR(value, exactValue(grid, p), tolerance) << x << " " << y;
          } else {
            EXPECT_TRUE(std::isfinite(value)) << x << " " << y;
          }
        }
      EXPECT_GT(inside, 200);
      EXPECT_LT(inside, kWidth * kHeight);
    }
}

// Whatever they sum to: the grid of scaled surpluses, rounded once more, to the point's own bounds. The field's values
// are all of one sign, so that the range's lower end moves with the coefficients' sum.
TEST(hbOglSparseGrid, OfAnyCoefficientsIsTheGridOfScaledSurpluses) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  hbGeometry geometry;
  geometry.size = hbSize3(17);
  for (const double sign : {1.0, -1.0}) {
    const hbSparseGrid grid = hbTestScenes::gridOf(
        geometry, 4, {[&](const glm::dvec3& p) { return sign * (2.0 + std::sin(5.0 * p.x) * p.y - p.z * p.z); }});
    for (const double scale : {0.6, 1.0, 1.7}) {
      const std::vector<double> coefficients = hbTestCombinations::coefficients(grid.indexSet(), scale, 5);
      const hbCombinationSparseGrid combination(grid, coefficients);
      const hbSparseGrid scaled = hbTestCombinations::scaledBy(grid, coefficients);
      const hbPointBounds bounds(scaled, combination);
      for (const hbGlFormat format : {hbGlFormat::r32f, hbGlFormat::r16f, hbGlFormat::r16, hbGlFormat::r8}) {
        const hbOglSparseGrid drawn(*context, combination, 0,
                                    {format, format, Form::exact, std::nullopt, Filter::exact});
        EXPECT_NEAR(drawn.valueOf(0.0), hbOglPointBounds(bounds).zero(format), 1e-12);
        const std::vector<float> out = drawnValues(*context, drawn, format, oblique());
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x) {
            const glm::dvec3 p = sample(oblique(), x, y);
            if (!isInside(p)) continue;
            const double bound =
                hbOglPointBounds(bounds).blend(p, format, glm::dvec3(hbOglRoundingBounds::kCoordinate)) +
                bounds.stored(p);
            EXPECT_NEAR(out[std::size_t(x + kWidth * y)], scaled.calcValue(p, 0), bound)
                << hb::glFormatName(format) << " " << scale << " " << x << " " << y;
          }
      }
    }
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
    positive += std::max(one.coefficient, 0.0);
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

// A field that is nearly constant, so that the coordinates' rounding (see hbOglRoundingBounds) hardly shows. What is
// left are the roundings of textures, of interpolation (see hb::kCombinationRoundings), and those of every blend: of
// what is added and of the partial sum, which depend on the order. 16-bit floats may be rounded towards 0.
TEST(hbOglSparseGrid, FloatTargetsLoseWhatTheirPartialSumsSay) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  constexpr double kSlope = 0.01;
  hbGeometry geometry;
  geometry.size = hbSize3(129);
  const hbCombinationSparseGrid grid(
      hbTestScenes::gridOf(geometry, 7, {[](const glm::dvec3& p) { return 0.7 + kSlope * (p.x + p.y + p.z); }}));
  std::vector<double> coefficients;
  for (const auto& one : grid.grids()) coefficients.push_back(one.coefficient);
  for (const auto& [format, unit] : {std::pair(hbGlFormat::r32f, 0x1p-24), {hbGlFormat::r16f, 0x1p-10}}) {
    std::map<Order, double> worst;
    for (const Order order : {Order::positiveFirst, Order::interleaved}) {
      std::vector<std::size_t> sequence = hb::interleaved(coefficients);
      if (order == Order::positiveFirst) {
        std::iota(sequence.begin(), sequence.end(), std::size_t{0});
        std::stable_partition(sequence.begin(), sequence.end(), [&](std::size_t i) { return coefficients[i] > 0; });
      }
      const hbOglSparseGrid drawn(*context, grid, 0, {format, format, Form::exact, order});
      const std::vector<float> out = drawnValues(*context, drawn, format, oblique());
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const glm::dvec3 p = sample(oblique(), x, y);
          if (!isInside(p)) continue;
          double sum = 0.0, bound = 0.0;
          for (const std::size_t i : sequence) {
            const double value = trilinear(grid, grid.grids()[i], p), term = coefficients[i] * value;
            sum += term;
            bound += unit * (std::abs(term) + std::abs(sum)) +
                     std::abs(coefficients[i]) *
                         (value * (hb::kCombinationRoundings * 0x1p-24 + unit) + kSlope * 3.0 * 8.0 * 0x1p-24);
          }
          const double error = std::abs(out[std::size_t(x + kWidth * y)] - sum);
          EXPECT_LE(error, bound) << x << " " << y;
          worst[order] = std::max(worst[order], error);
        }
    }
    // 43 positive terms make partial sums of up to 43 times the value, taken in turn of up to twice.
    EXPECT_LT(3.0 * worst[Order::interleaved], worst[Order::positiveFirst]) << hb::glFormatName(format);
  }
}

TEST(hbOglSparseGrid, SixteenBitFloatsTakeValuesBeyondTheirRange) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  hbSparseGrid::Frame frame;
  frame.geometry.size = hbSize3(3);
  const hbIndexSet set = hbIndexSet::regular(1, hbIndexSet::axesOf(frame.geometry.size));
  const hbCombinationSparseGrid grid(hbSparseGrid::fromNodalValues(
      frame, set, {std::vector<double>(std::size_t(set.storedValues()), 1e9)})); // they end at 65504
  const hbOglSparseGrid drawn(*context, grid, 0, {hbGlFormat::r16f, hbGlFormat::r16f, Form::exact});
  const std::vector<float> out = drawnValues(*context, drawn, hbGlFormat::r16f,
                                             {{0.2, 0.2, 0.2}, {1e-3, 0.0, 0.0}, {0.0, 1e-3, 0.0}, {0, 0, 1, 1}});
  EXPECT_NEAR(out[0], 1e9, 1e9 * 0x1p-10);
}

TEST(hbOglSparseGrid, OrdersThatClampAreRefused) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbCombinationSparseGrid grid = gridOf("smooth", hbIndexSet::regular(3, {}));
  EXPECT_THROW(hbOglSparseGrid(*context, grid, 0, {hbGlFormat::r16, hbGlFormat::r16, Form::exact, Order::interleaved}),
               hbError);
}

// Whatever textures are on the device, the same are drawn in the same order.
TEST(hbOglSparseGrid, StreamingDrawsTheSame) {
  const auto context = hbGlContext::create(hbGlContext::Kind::osmesa);
  const hbGlCurrent current(*context);
  const hbCombinationSparseGrid grid = gridOf("hydrogen", hbIndexSet::regular(5, {}));
  hbOglSparseGrid::Options options;
  const hbOglSparseGrid whole(*context, grid, 0, options);
  EXPECT_EQ(whole.residentBytes(), whole.textureBytes());
  const std::int64_t bytes = whole.textureBytes(), largest = 4 * 3 * 3 * 33;
  options.memory = bytes;
  EXPECT_EQ(hbOglSparseGrid(*context, grid, 0, options).residentBytes(), bytes);
  for (const std::int64_t memory : {bytes - 1, bytes / 2, largest}) {
    options.memory = memory;
    options.stream = false;
    try {
      const hbOglSparseGrid refused(*context, grid, 0, options);
      FAIL() << memory;
    } catch (const hbError& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(bytes)), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(std::to_string(memory)), std::string::npos) << error.what();
    }
    options.stream = true;
    const hbOglSparseGrid streamed(*context, grid, 0, options);
    EXPECT_LE(streamed.residentBytes(), memory - largest);
    EXPECT_EQ(streamed.residentBytes() == 0, memory == largest);
    // Two planes at a time, too.
    const hbOglSparseGrid::Plane one = oblique(), other{{0.1, 0.1, 0.3}, one.right, one.down, one.window};
    const hbOglTiles tiles(kWidth, kHeight, 2, 16384);
    const hbGlTarget both(context->gl(), tiles.targetWidth(), tiles.targetHeight(), hbGlFormat::r32f);
    std::vector<float> expected, found;
    whole.draw(std::array{one, other}, tiles, both);
    both.read(expected);
    streamed.draw(std::array{one, other}, tiles, both);
    both.read(found);
    EXPECT_EQ(found, expected);
  }
  options.memory = largest - 1;
  EXPECT_THROW(hbOglSparseGrid(*context, grid, 0, options), hbError);
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
