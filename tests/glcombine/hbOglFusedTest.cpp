#include "glcombine/hbOglFused.h"

#include <array>
#include <cmath>
#include <span>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "sparsegrid/hbRoundingBounds.h"
#include "tests/raycast/hbTestScenes.h"
#include "tests/sparsegrid/hbTestSets.h"

using namespace hbTestScenes;

namespace {

double slowWaves(const glm::dvec3& p) { return std::cos(3.0 * p.x - 1.0) + 0.6 * p.y - p.z * p.y; }

/// The samples along the rays of a picture in 64 bits, from another evaluation, and how far a shader's may be from
/// them.
class Reference {
public:
  Reference(const hbSparseGrid& grid, const hbPlaneRays& rays, double atOnePoint)
      : grid_(grid), rays_(rays), slopes_(hb::slopeBounds(grid, rays.scene().component)), atOnePoint_(atOnePoint),
        first_(rays.plane(0)), last_(rays.plane(rays.planes() - 1)) {
    for (std::size_t pixel = 0; pixel < rays.rays().size(); ++pixel)
      for (int i = rays.rays()[pixel].first; i <= rays.rays()[pixel].last; ++i) samples_.push_back(at(pixel, i));
    samples_ = evaluated(samples_);
    std::size_t next = 0;
    for (const hbPlaneRays::Ray& ray : rays.rays()) {
      begin_.push_back(next);
      next += std::size_t(std::max(0, ray.last - ray.first + 1));
    }
  }

  struct Sample {
    glm::dvec3 point{0.0};
    double bound = 0.0;  ///< Of the value.
    glm::dvec3 off{0.0}; ///< Of the point.
    double value = 0.0;
  };

  /// Of a place, without its value.
  Sample at(std::size_t pixel, double place) const {
    Sample sample{rays_.at(pixel, place)};
    const auto width = std::size_t(rays_.scene().width);
    const double x = double(pixel % width) + 0.5, y = double(pixel / width) + 0.5;
    const double steps = std::max(1, rays_.planes() - 1);
    const auto magnitude = [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::abs(a) + place / steps * glm::abs(b - a);
    };
    // pointOfRay: of each product of uniforms, place and pixel, these (6 at the most) are rounded: the uniform, two
    // products, the sum inside and the two outside.
    sample.off = 6.0 * 0x1p-24 *
                 (magnitude(first_.corner, last_.corner) + x * magnitude(first_.right, last_.right) +
                  y * magnitude(first_.down, last_.down));
    sample.bound = atOnePoint_ + glm::dot(slopes_, sample.off);
    return sample;
  }

  std::vector<Sample> evaluated(std::vector<Sample> samples) const {
    std::vector<double> x, y, z, value(samples.size());
    for (const Sample& sample : samples) {
      x.push_back(sample.point.x);
      y.push_back(sample.point.y);
      z.push_back(sample.point.z);
    }
    grid_.values(hbPoints64{x, y, z}, rays_.scene().component, value);
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].value = value[i];
    return samples;
  }

  std::span<const Sample> along(std::size_t pixel) const {
    const hbPlaneRays::Ray& ray = rays_.rays()[pixel];
    return std::span(samples_).subspan(begin_[pixel], std::size_t(std::max(0, ray.last - ray.first + 1)));
  }
  const glm::dvec3& slopes() const { return slopes_; }

private:
  const hbSparseGrid& grid_;
  const hbPlaneRays& rays_;
  glm::dvec3 slopes_;
  double atOnePoint_;
  hbPlaneRays::Plane first_, last_;
  std::vector<Sample> samples_;
  std::vector<std::size_t> begin_;
};

void expectXray(std::span<const Reference::Sample> samples, float found) {
  double sum = 0.0, bound = 0.0, magnitude = 0.0;
  for (const Reference::Sample& sample : samples) {
    sum += sample.value;
    bound += sample.bound;
    magnitude += std::abs(sample.value) + sample.bound;
  }
  // No partial sum exceeds the sum of the magnitudes; a value is rounded with its block and then with the blocks.
  const double roundings = hbOglFused::kBlock + double(samples.size()) / hbOglFused::kBlock + 2.0;
  EXPECT_NEAR(found, sum, bound + roundings * 0x1p-24 * magnitude);
}

void expectMip(std::span<const Reference::Sample> samples, float found) {
  double least = hbOglFused::kLeast, most = least;
  for (const Reference::Sample& sample : samples) {
    least = std::max(least, sample.value - sample.bound);
    most = std::max(most, sample.value + sample.bound);
  }
  EXPECT_GE(found, least);
  EXPECT_LE(found, most);
}

/// Of values that may be off by their bounds, steps between two planes are crossings for certain, perhaps or not at
/// all. What is found must be one of those up to the first that is certain. Returns whether there is one.
bool expectIso(std::span<const Reference::Sample> samples, double iso, int first, float found) {
  bool isPossible = false;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const Reference::Sample &a = samples[i - 1], &b = samples[i];
    const double plane = first + double(i) - 1.0;
    const bool isClear = std::abs(a.value - iso) > a.bound && std::abs(b.value - iso) > b.bound;
    const bool isCrossing = (a.value >= iso) != (b.value >= iso);
    if (isClear && !isCrossing) continue;
    // t = (iso - a) / (b - a): a numerator that is off by a's bound, a denominator by both's, each rounded, as are the
    // quotient (with 2.5 units in the last place, as OpenGL allows) and the place.
    const double step = std::abs(b.value - a.value), off = a.bound + b.bound;
    const double t = isCrossing ? (iso - a.value) / (b.value - a.value) : 0.5;
    const double tolerance =
        isCrossing && step > 2.0 * off ? 2.0 * off / (step - off) + (2.0 + 5.0 + plane + 1.0) * 0x1p-24 : 1.0;
    isPossible = isPossible || std::abs(found - (plane + t)) <= tolerance;
    if (!isClear) continue;
    EXPECT_TRUE(isPossible) << found << ", where " << plane + t << " is certain";
    return true;
  }
  EXPECT_TRUE(isPossible || found == hbOglRays::kNowhere) << found;
  return false;
}

/// What the differences at the places found should be.
void expectDifferences(const Reference& reference, const hbPlaneRays& rays, double atOnePoint,
                       const std::vector<float>& places, const std::vector<float>& found) {
  const hbGeometry& geometry = rays.field().geometry();
  std::vector<Reference::Sample> samples; // seven a place: there, and on either side along each axis
  for (std::size_t pixel = 0; pixel < places.size(); ++pixel) {
    if (places[pixel] == hbOglRays::kNowhere) continue;
    const Reference::Sample there = reference.at(pixel, places[pixel]);
    samples.push_back(there);
    for (int d = 0; d < 3; ++d)
      for (const double side : {-1.0, 1.0}) {
        Reference::Sample& beside = samples.emplace_back(there);
        beside.point[d] = std::clamp(there.point[d] + side * geometry.cubeSpacing()[d], 0.0, 1.0);
      }
  }
  samples = reference.evaluated(std::move(samples));
  std::size_t next = 0;
  for (std::size_t pixel = 0; pixel < places.size(); ++pixel) {
    const float* four = &found[4 * pixel];
    if (places[pixel] == hbOglRays::kNowhere) {
      EXPECT_EQ(std::vector<float>(four, four + 4), std::vector<float>(4, 0.0F));
      continue;
    }
    const Reference::Sample* at = &samples[next];
    next += 7;
    EXPECT_NEAR(four[0], at->value, at->bound);
    for (int d = 0; d < 3; ++d) {
      const Reference::Sample &lower = at[1 + 2 * d], &upper = at[2 + 2 * d];
      if (geometry.isFlat(d)) {
        EXPECT_EQ(four[1 + d], 0.0F);
        continue;
      }
      const double span = upper.point[d] - lower.point[d];
      // Both points are rounded twice more, by 2^-24 of something up to 2; they divide by the span of those they are,
      // so that points that are off move both the values and the span.
      const glm::dvec3 off = at->off + 4.0 * 0x1p-24;
      const double values = 2.0 * (atOnePoint + glm::dot(reference.slopes(), off));
      const double exact = (upper.value - lower.value) / span;
      // The difference, the span, and the quotient (2.5 units in the last place).
      const double roundings = (1.0 + 1.0 + 5.0) * 0x1p-24 * std::abs(exact);
      EXPECT_NEAR(four[1 + d], exact, (values + 2.0 * off[d] * std::abs(exact)) / (span - 2.0 * off[d]) + roundings)
          << "along "
          << "xyz"[d];
    }
  }
}

class hbOglFusedTest : public testing::TestWithParam<hbGlContext::Kind> {
protected:
  hbOglFusedTest() : context_(hbGlContext::create(GetParam())), current_(*context_) {}

  struct Form {
    std::unique_ptr<const hbOglFused> fused;
    double atOnePoint;
  };
  std::array<Form, 2> formsOf(const hbSparseGrid& grid, int component) const {
    return {Form{std::make_unique<const hbOglFused>(*context_, hbCombinationSparseGrid(grid), component),
                 hb::oglCombinationBound(grid, component)},
            Form{std::make_unique<const hbOglFused>(*context_, hbSemiNodalGrid(grid), component),
                 hb::oglSemiNodalBound(grid, component)}};
  }

  /// A picture by one form; returns how many surfaces are certain.
  int expectTheReference(const Form& form, const hbSparseGrid& grid, const hbScene& scene) const {
    const hbGlFunctions& gl = context_->gl();
    const hbPlaneRays planes(grid, scene);
    const hbOglRays rays(gl, planes);
    const Reference reference(grid, planes, form.atOnePoint);
    const hbGlTarget target(gl, scene.width, scene.height, hbGlFormat::r32f),
        four(gl, scene.width, scene.height, hbGlFormat::r32f, 4);
    target.clear(3.0F);
    gl.Enable(GL_BLEND); // as others might leave it
    gl.BlendFunc(GL_ONE, GL_ONE);
    form.fused->march(rays, target);
    std::vector<float> found;
    target.read(found);
    int surfaces = 0;
    for (std::size_t pixel = 0; pixel < found.size(); ++pixel) {
      SCOPED_TRACE(pixel);
      const auto samples = reference.along(pixel);
      if (scene.mode == hbMode::xray) expectXray(samples, found[pixel]);
      if (scene.mode == hbMode::mip) expectMip(samples, found[pixel]);
      if (scene.mode == hbMode::iso)
        surfaces += expectIso(samples, planes.iso(), planes.rays()[pixel].first, found[pixel]) ? 1 : 0;
    }
    if (scene.mode != hbMode::iso) return 0;
    form.fused->differences(rays, target, four);
    std::vector<float> differences;
    four.read(differences);
    expectDifferences(reference, planes, form.atOnePoint, found, differences);
    return surfaces;
  }

  /// Pictures of all modes by both forms, likewise.
  int expectTheReference(const hbSparseGrid& grid, const std::vector<hbCamera>& cameras, int component = 0,
                         const glm::ivec2& size = {19, 13}, int samples = 9) const {
    int surfaces = 0;
    for (const Form& form : formsOf(grid, component))
      for (const hbCamera& camera : cameras)
        for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso}) {
          hbScene scene = sceneOf(mode, camera, size.x, size.y, samples);
          scene.component = component;
          scene.sampling.kind = hbSampling::Kind::planewise;
          surfaces += expectTheReference(form, grid, scene);
        }
    return surfaces;
  }

  std::unique_ptr<hbGlContext> context_;
  hbGlCurrent current_;
};

} // namespace

TEST_P(hbOglFusedTest, PicturesAreThePlanewiseOnesFromEverywhere) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward()})
    EXPECT_GT(expectTheReference(gridOf(g, 3, {waves}), cameras(g)), 1500);
}

TEST_P(hbOglFusedTest, FlatTwoNodeAndCappedAxes) {
  for (const hbSize3& size : {hbSize3(9, 9, 1), hbSize3(1, 9, 5), hbSize3(5, 1, 9), hbSize3(2, 9, 9), hbSize3(17, 2, 5),
                              hbSize3(9, 5, 2), hbSize3(33, 3, 5)}) {
    SCOPED_TRACE(testing::Message() << size.x << " " << size.y << " " << size.z);
    const hbGeometry g = box(size, {1.0, 0.8, 0.6});
    std::vector<hbCamera> some = cameras(g);
    some.erase(some.begin(), some.end() - 6); // perspective: oblique ones from outside, and those from inside
    EXPECT_GT(expectTheReference(gridOf(g, 4, {waves}), some), 100);
  }
}

TEST_P(hbOglFusedTest, SetsThatAreNotRegular) {
  const hbGeometry g = box({9, 9, 9}, {1.0, 0.8, 0.6});
  std::vector<hbCamera> some = cameras(g);
  some.erase(some.begin(), some.end() - 3);
  EXPECT_GT(expectTheReference(gridOf(g, hbTestSets::uneven(), {waves}), some), 50);
}

TEST_P(hbOglFusedTest, AlignedLatticesAndSeveralComponents) {
  const hbGeometry g = box({7, 12, 6}, {1.0, 0.8, 0.6});
  std::vector<double> samples;
  for (const double z : g.cubeCoordinates(2))
    for (const double y : g.cubeCoordinates(1))
      for (const double x : g.cubeCoordinates(0))
        for (const auto& f : {waves, slowWaves}) samples.push_back(f({x, y, z}));
  const hbVolumeField field(hbVolume::fromSamples(g, std::move(samples), 2));
  const hbSparseGrid grid =
      hbSparseGrid::interpolate(field, hbIndexSet::full(hbIndexSet::axesOf(g.size)), hbLatticeMapping::aligned);
  ASSERT_NE(grid.latticeScale(), glm::dvec3(1.0));
  std::vector<hbCamera> some = cameras(g);
  some.erase(some.begin(), some.end() - 6);
  for (const int component : {0, 1}) EXPECT_GT(expectTheReference(grid, some, component), 100);
}

// Added up one after the other in 32 bits, each of the later values would lose 0.45 * 2^-12: in all more than
// twice what blocks may.
TEST_P(hbOglFusedTest, LongXraysAreSummedInBlocks) {
  const hbGeometry g = box({3, 3, 3}, {1.0, 1.0, 1.0});
  const hbIndexSet set = hbIndexSet::full(hbIndexSet::axesOf(g.size));
  const hbSparseGrid grid = hbSparseGrid::fromNodalValues({g, {}, hbLatticeMapping::fitted}, set,
                                                          {std::vector<double>(27, 1.0 + 0.45 * 0x1p-12)});
  const hbGlFunctions& gl = context_->gl();
  hbScene scene = sceneOf(hbMode::xray, hbCamera::framing(g, 0.0, 0.0, hbCamera::Projection::orthographic), 4, 3, 4096);
  scene.sampling.kind = hbSampling::Kind::planewise;
  const hbPlaneRays planes(grid, scene);
  const hbOglRays rays(gl, planes);
  for (const Form& form : formsOf(grid, 0)) {
    const hbGlTarget target(gl, 4, 3, hbGlFormat::r32f);
    form.fused->march(rays, target);
    std::vector<float> found;
    target.read(found);
    const Reference reference(grid, planes, form.atOnePoint);
    ASSERT_GE(reference.along(5).size(), 4000U);
    expectXray(reference.along(5), found[5]);
    EXPECT_GT(found[5], 4000.0F);
  }
}

// Of 31 component grids or of 26 lines, 2100 planes take more turns than Mesa does in a draw, and 4300 more than twice
// as many. The field rises along the first camera's axis: the greatest value lies on the last planes, the surface at
// four fifths of the way.
TEST_P(hbOglFusedTest, MarchesOfMoreTurnsThanMesaTakesAreWhole) {
  const hbGeometry g = box({33, 33, 33}, {1.0, 1.0, 1.0});
  const std::vector<hbCamera> fromBothSides{hbCamera::framing(g, 35.0, 20.0, hbCamera::Projection::orthographic),
                                            hbCamera::framing(g, 215.0, -20.0, hbCamera::Projection::orthographic)};
  const glm::dvec3 axis = fromBothSides[0].viewAxis();
  const hbSparseGrid grid = gridOf(g, 5, {[&](const glm::dvec3& p) { return glm::dot(p - 0.5, axis) - 0.1; }});
  ASSERT_EQ(hbCombinationSparseGrid(grid).grids().size(), 31U);
  for (const int samples : {2100, 4300}) EXPECT_GT(expectTheReference(grid, fromBothSides, 0, {5, 4}, samples), 15);
}

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglFusedTest, testing::Values(hbGlContext::Kind::osmesa, hbGlContext::Kind::egl),
                         [](const auto& kind) { return kind.param == hbGlContext::Kind::egl ? "egl" : "osmesa"; });
