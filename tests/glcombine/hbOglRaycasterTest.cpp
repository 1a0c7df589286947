#include "glcombine/hbOglRaycaster.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "raycast/hbRaycaster.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "tests/glcombine/hbGlBounds.h"
#include "tests/raycast/hbDvrBounds.h"
#include "tests/raycast/hbDvrScenes.h"

using namespace hbTestScenes;

namespace {

/// By which library, and how a picture is drawn.
struct Way {
  std::string name;
  hbGlContext::Kind kind;
  hbOglRaycaster::Options options;
  double texels = 0.0; ///< How far they are rounded, of the range of the nodal values.
};

std::vector<Way> ways() {
  using Form = hbOglRaycaster::Form;
  std::vector<Way> list;
  for (const auto& [name, kind] :
       {std::pair("Osmesa", hbGlContext::Kind::osmesa), std::pair("Egl", hbGlContext::Kind::egl)}) {
    const auto add = [&, kind = kind, name = std::string(name)](const char* how, const hbOglRaycaster::Options& options,
                                                                double texels = 0.0) {
      list.push_back({name + how, kind, options, texels});
    };
    hbOglRaycaster::Options blend{Form::blend};
    add("Blend", blend);
    blend.blend.filter = hbOglSparseGrid::Filter::exact;
    blend.blend.order = hbOglSparseGrid::Order::positiveFirst;
    blend.blend.form = hbTextureLayout::Form::padded;
    add("BlendExactlyPaddedPositiveFirst", blend);
    // Values mapped to [0,1], and divided by the greatest: half a step, and half of a last place.
    blend = {.form = Form::blend};
    blend.blend.textures = hbGlFormat::r16;
    add("BlendFixedTextures", blend, 0x1p-17);
    blend.blend.textures = hbGlFormat::r16f;
    add("BlendHalfTextures", blend, 0x1p-11);
    blend.readBack = true;
    add("BlendHalfTexturesReadBack", blend, 0x1p-11);
    add("BlendReadBack", {Form::blend, true});
    add("Fused", {Form::fused});
    add("Seminodal", {Form::seminodal});
  }
  return list;
}

class hbOglRaycasterTest : public testing::TestWithParam<Way> {
protected:
  std::unique_ptr<hbGlContext> context = hbGlContext::create(GetParam().kind);
  hbGlCurrent current{*context};

  hbPicture drawn(const hbSparseGrid& grid, const hbScene& scene) const {
    return hbOglRaycaster(*context, grid, scene, GetParam().options).render();
  }
};

/// Each form once, of floats, and one by the other library: what they have in common is tested by all ways().
std::vector<Way> someWays() {
  std::vector<Way> list;
  for (const Way& way : ways())
    for (const char* name : {"OsmesaBlend", "OsmesaFused", "OsmesaSeminodal", "EglSeminodal"})
      if (way.name == name) list.push_back(way);
  return list;
}

/// White matter of one opacity a unit of length.
hbTransferFunction constant(double opacity) {
  hbTransferFunction::Definition d;
  d.colors = {{0.0, glm::dvec3(1.0)}, {1.0, glm::dvec3(1.0)}};
  d.opacities = {{0.0, opacity}, {1.0, opacity}};
  d.unitLength = 1.0;
  return hbTransferFunction(std::move(d));
}

class hbOglDvrTest : public hbOglRaycasterTest {};

/// From the front, and obliquely; by perspective from within.
std::vector<hbCamera> someCameras(const hbGeometry& g) {
  const std::vector<hbCamera> all = cameras(g);
  return {all[0], all[6], all[all.size() / 2 + 9]};
}

/// How far the true values that are looked up may be from the combination engine's. Numbers less the range's first one,
/// times entries a number: all three, and what is between, are rounded.
double ofValues(const hbCombinationSparseGrid& grid, const hbPlaneRays& rays, double texels) {
  const auto [lo, hi] = rays.scene().transfer->range();
  hbGlBounds bounds(grid, rays);
  return bounds.withTexels(texels).values() + 0x1p-24 * (std::abs(lo) + bounds.largest() + 4.0 * (hi - lo));
}

void expectNear(const hbPicture& found, const hbPicture& expected, const hbPlaneRays& rays, double perValue) {
  const hbDvrBounds bounds(rays);
  const std::vector<float> opacities = channel(expected, "A"), ours = channel(found, "A");
  for (std::size_t i = 0; i < opacities.size(); ++i) {
    const double moved = bounds.channel(i, perValue) + bounds.inFloats(i);
    const double tolerance = moved + hbDvrBounds::ends(opacities[i], ours[i], moved) + 0x1p-22; // shown in floats
    for (const char* name : {"R", "G", "B", "A", "Y"})
      EXPECT_NEAR(channel(found, name)[i], channel(expected, name)[i], tolerance) << name << i;
  }
}

hbScene planewise(hbMode mode, const hbCamera& camera) {
  hbScene scene = sceneOf(mode, camera, 19, 13);
  scene.sampling.kind = hbSampling::Kind::planewise;
  return scene;
}

} // namespace

TEST_P(hbOglRaycasterTest, XrayAndMipAreThePlanewisePicturesOfTheCombination) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward(), box({9, 1, 5}, {1.0, 0.3, 2.0})}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    const hbCombinationSparseGrid combination(grid);
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        const hbScene scene = planewise(mode, camera);
        const hbPicture expected = hbRaycaster(combination, scene).render(), found = drawn(grid, scene);
        EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
        const std::vector<float> ys = channel(found, "Y"), exact = channel(expected, "Y");
        hbGlBounds bounds(combination, hbPlaneRays(combination, scene));
        bounds.withTexels(GetParam().texels);
        const double longest = glm::length(g.extent()) + scene.sampling.stepLength(g, camera) * 16.0;
        const double tolerance = mode == hbMode::xray ? bounds.sums() * longest : bounds.values();
        for (std::size_t i = 0; i < ys.size(); ++i)
          EXPECT_NEAR(ys[i], exact[i], tolerance + 0x1p-22 * std::abs(exact[i])) << i;
      }
  }
}

// Of a linear field, whose surfaces are planes wherever they are cut.
TEST_P(hbOglRaycasterTest, IsoSurfacesAreThePlanewiseOnes) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {[](const glm::dvec3& p) { return p.x + 2.0 * p.y + 3.0 * p.z - 2.7; }});
  const hbCombinationSparseGrid combination(grid);
  int surfaces = 0;
  for (const hbCamera& camera : cameras(g)) {
    const hbScene scene = planewise(hbMode::iso, camera);
    const hbPicture expected = hbRaycaster(combination, scene).render(), found = drawn(grid, scene);
    const hbPlaneRays rays(combination, scene);
    const double perValue = hbGlBounds(combination, rays).withTexels(GetParam().texels).values();
    EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
    const double step = scene.sampling.stepLength(g, camera);
    for (std::size_t i = 0; i < channel(found, "A").size(); ++i) {
      if (channel(expected, "A")[i] == 0.0F) continue;
      ++surfaces;
      const glm::dvec3 way(glm::inverse(g.cubeToWorld()) * glm::dvec4(rays.direction(i), 0.0));
      const double slope = std::abs(glm::dot(way, glm::dvec3(1.0, 2.0, 3.0))); // along the ray
      // Both ends of the step between two planes are off by as much as a value is, in either picture; a place is
      // rounded to floats, and so are the three operations that find it.
      const double z = channel(expected, "Z")[i];
      const double place = 2.0 * perValue / slope + (rays.planes() + 4) * 0x1p-24 * step;
      EXPECT_NEAR(channel(found, "Z")[i], z, place + 0x1p-22 * std::abs(z)) << i;
      EXPECT_NEAR(channel(found, "value")[i], channel(expected, "value")[i],
                  perValue + place * slope / rays.rays()[i].cosine)
          << i;
      // Slopes are differences of two values over a sample spacing at the least, each off by as much as a value is;
      // lengths are the world's. The gradient there is longer than 2, by which a unit normal moves less, and that
      // leaves room for the third axis' shear.
      const double perSlope = 2.0 * perValue * glm::length(1.0 / (g.cubeSpacing() * g.extent()));
      for (const char* n : {"Y", "N.X", "N.Y", "N.Z"})
        EXPECT_NEAR(channel(found, n)[i], channel(expected, n)[i], perSlope) << n << i;
    }
  }
  EXPECT_GT(surfaces, 500);
}

// Of the light, too, that rays between two planes show.
TEST_P(hbOglRaycasterTest, DvrIsThePlanewisePicture) {
  int seen = 0, opaque = 0, between = 0;
  for (const hbGeometry& g : {awkward(), box({9, 1, 5}, {1.0, 0.3, 2.0})}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    const hbCombinationSparseGrid combination(grid);
    const std::vector<hbCamera> some = someCameras(g);
    for (const hbCamera& camera : g.isFlat(1) ? std::vector{some[1]} : some) {
      const hbScene scene = dvrScene(ramp(), camera, 9, hbSampling::Kind::planewise);
      const hbPlaneRays rays(combination, scene);
      const hbPicture found = drawn(grid, scene);
      expectNear(found, hbRaycaster(combination, scene).render(), rays, ofValues(combination, rays, GetParam().texels));
      for (std::size_t i = 0; i < rays.rays().size(); ++i)
        between += rays.rays()[i].last < rays.rays()[i].first && rays.rays()[i].before > 0.0;
      const std::vector<float> opacities = channel(found, "A");
      seen += int(std::count_if(opacities.begin(), opacities.end(), [](float a) { return a > 0.0F; }));
      opaque += int(std::count_if(opacities.begin(), opacities.end(), [](float a) { return a > 0.999F; }));
    }
  }
  EXPECT_GT(seen, 400);
  EXPECT_GT(opaque, 10);
  EXPECT_GT(between, 5);
}

TEST_P(hbOglDvrTest, PreintegratedIsThePlanewisePicture) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 3, {waves});
  const hbCombinationSparseGrid combination(grid);
  hbScene scene = dvrScene(ramp(0.3), someCameras(g)[1], 40, hbSampling::Kind::planewise);
  scene.preintegrated = true;
  const hbPlaneRays rays(combination, scene);
  expectNear(drawn(grid, scene), hbRaycaster(combination, scene).render(), rays,
             ofValues(combination, rays, GetParam().texels));
}

// Pictures in turn, of renderers that live at the same time, are those of a context that has seen nothing else; from
// another place, those of a new renderer.
TEST_P(hbOglDvrTest, EveryTransferFunctionShowsItself) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  const hbScene one = dvrScene(ramp(), hbCamera::framing(g), 9), other = dvrScene(ramp(0.4), *one.camera, 9);
  std::vector<hbPicture> pictures;
  for (const hbScene& scene : {one, other}) pictures.push_back(drawn(grid, scene));
  EXPECT_NE(pictures[0].channels, pictures[1].channels);
  hbOglRaycaster first(*context, grid, one, GetParam().options), second(*context, grid, other, GetParam().options);
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ(first.render().channels, pictures[0].channels);
    EXPECT_EQ(second.render().channels, pictures[1].channels);
  }
  hbScene beside = one; // whose planes lie closer
  beside.camera = someCameras(g)[0];
  EXPECT_NE(beside.sampling.stepLength(g, *beside.camera), one.sampling.stepLength(g, *one.camera));
  first.look(*beside.camera);
  EXPECT_EQ(first.render().channels, drawn(grid, beside).channels);
  context->release();
  {
    const auto fresh = hbGlContext::create(GetParam().kind);
    const hbGlCurrent thereCurrent(*fresh);
    EXPECT_EQ(hbOglRaycaster(*fresh, grid, other, GetParam().options).render().channels, pictures[1].channels);
  }
  context->makeCurrent();
}

// exp(-extinction length), whatever there is of planes.
TEST_P(hbOglDvrTest, AHomogeneousMediumIsExact) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {[](const glm::dvec3&) { return 0.5; }});
  for (const hbCamera& camera : someCameras(g)) {
    const hbScene scene = dvrScene(constant(0.3), camera, 3);
    const hbPlaneRays rays(grid, scene);
    const hbDvrBounds bounds(rays);
    const std::vector<float> found = channel(drawn(grid, scene), "A");
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) {
        const auto i = std::size_t(x + scene.width * y);
        const auto way = inCube(g, scene, x, y);
        // No ray becomes opaque. The entry itself is a float.
        EXPECT_NEAR(found[i], way ? 1.0 - std::pow(1.0 - 0.3, way->length) : 0.0, bounds.inFloats(i) + 0x1p-24) << i;
      }
  }
}

// In the same medium, but denser: there is no slope by which values could move anything.
TEST_P(hbOglDvrTest, OpaqueRaysEndWhereTheyDoInSoftware) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {[](const glm::dvec3&) { return 0.5; }});
  hbScene scene = dvrScene(constant(0.95), someCameras(g)[1], 30, hbSampling::Kind::planewise);
  for (const bool isPreintegrated : {false, true}) {
    scene.preintegrated = isPreintegrated;
    const hbPicture expected = hbRaycaster(grid, scene).render();
    expectNear(drawn(grid, scene), expected, hbPlaneRays(grid, scene), 0.0);
    const std::vector<float> opacities = channel(expected, "A");
    EXPECT_GT(std::count_if(opacities.begin(), opacities.end(), [](float a) { return a > 0.9991F; }), 10);
  }
}

// Of a linear field, which no component grid interpolates to values outside its range: there is no room for those.
TEST(hbOglRaycaster, DvrByFixedPointTargets) {
  const auto context = hbGlContext::create();
  const hbGlCurrent current(*context);
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {[](const glm::dvec3& p) { return 0.3 * p.x + p.y - 0.5 * p.z; }});
  const hbCombinationSparseGrid combination(grid);
  hbOglRaycaster::Options options{hbOglRaycaster::Form::blend};
  options.blend.textures = options.blend.target = hbGlFormat::r16;
  double positive = 0.0, terms = 0.0;
  for (const auto& one : combination.grids()) {
    positive += std::max(one.coefficient, 0);
    ++terms;
  }
  for (const hbCamera& camera : someCameras(g)) {
    const hbScene scene = dvrScene(ramp(), camera, 9, hbSampling::Kind::planewise);
    const hbPlaneRays rays(combination, scene);
    // Values range over 1.8, of which the target's numbers are one divided by the sum of positive coefficients: each
    // drawn is rounded to the nearest of 2^16 - 1 steps, as are texels.
    const double steps = terms * 1.8 * positive * 0.5 / 65535.0;
    expectNear(hbOglRaycaster(*context, grid, scene, options).render(), hbRaycaster(combination, scene).render(), rays,
               ofValues(combination, rays, 0x1p-17) + steps);
  }
}

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglRaycasterTest, testing::ValuesIn(ways()),
                         [](const auto& way) { return way.param.name; });
INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglDvrTest, testing::ValuesIn(someWays()),
                         [](const auto& way) { return way.param.name; });
