#include "glcombine/hbOglRaycaster.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbOglRoundingBounds.h"
#include "raycast/hbRaycaster.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "tests/raycast/hbDvrBounds.h"
#include "tests/raycast/hbDvrScenes.h"
#include "tests/raycast/hbLitBounds.h"
#include "volume/hbError.h"

using namespace hbTestScenes;

namespace {

/// By which library, and how a picture is drawn.
struct Way {
  std::string name;
  hbGlContext::Kind kind;
  hbOglRaycaster::Options options;
  double texels = 0.0; ///< How far they are rounded, of the range of the nodal values.
};

void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

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

std::vector<Way> waysNamed(std::initializer_list<const char*> names) {
  std::vector<Way> list;
  for (const Way& way : ways())
    for (const char* name : names)
      if (way.name == name) list.push_back(way);
  return list;
}

/// All; sanitized, which takes ten times as long, each by one of the two libraries in turn.
std::vector<Way> testedWays() {
  std::vector<Way> list = ways();
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  const std::size_t half = list.size() / 2;
  for (std::size_t i = 1; i < half; i += 2) list[i] = list[half + i];
  list.resize(half);
#endif
  return list;
}

/// Each form once, of floats, and one by the other library: what they have in common is tested by all ways().
std::vector<Way> someWays() { return waysNamed({"OsmesaBlend", "OsmesaFused", "OsmesaSeminodal", "EglSeminodal"}); }

/// White matter of one opacity a unit of length.
hbTransferFunction constant(double opacity) {
  hbTransferFunction::Definition d;
  d.colors = {{0.0, glm::dvec3(1.0)}, {1.0, glm::dvec3(1.0)}};
  d.opacities = {{0.0, opacity}, {1.0, opacity}};
  d.unitLength = 1.0;
  return hbTransferFunction(std::move(d));
}

class hbOglDvrTest : public hbOglRaycasterTest {};
class hbOglSceneTest : public hbOglRaycasterTest {};
class hbOglLitTest : public hbOglRaycasterTest {};
class hbOglLongTest : public hbOglRaycasterTest {};

/// From the front, and obliquely; by perspective from within.
std::vector<hbCamera> someCameras(const hbGeometry& g) {
  const std::vector<hbCamera> all = cameras(g);
  return {all[0], all[6], all[all.size() / 2 + 9]};
}

/// How far looking a true value up moves it. Numbers less the range's first one, times entries a number: all three, and
/// what is between, are rounded.
double ofLookUp(const hbPlaneRays& rays, double largest) {
  const auto [lo, hi] = rays.scene().transfer->range();
  return 0x1p-24 * (std::abs(lo) + largest + 4.0 * (hi - lo));
}

/// How far the true values that are looked up may be from the combination engine's.
double ofValues(const hbCombinationSparseGrid& grid, const hbPlaneRays& rays, double texels) {
  hbOglRoundingBounds bounds(grid, rays);
  return bounds.withTexels(texels).values() + ofLookUp(rays, bounds.largest());
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

/// Of a linear field, whose surfaces are planes wherever they are cut. `perValue`: how far values may differ.
const glm::dvec3 kSlopes(1.0, 2.0, 3.0);
double linear(const glm::dvec3& p) { return glm::dot(kSlopes, p) - 2.7; }
int expectSurfacesNear(const hbPicture& found, const hbPicture& expected, const hbPlaneRays& rays, double perValue) {
  const hbGeometry& g = rays.field().geometry();
  const double step = rays.step();
  int surfaces = 0;
  EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
  for (std::size_t i = 0; i < channel(found, "A").size(); ++i) {
    if (channel(expected, "A")[i] == 0.0F) continue;
    ++surfaces;
    const glm::dvec3 way(glm::inverse(g.cubeToWorld()) * glm::dvec4(rays.direction(i), 0.0));
    const double slope = std::abs(glm::dot(way, kSlopes)); // along the ray
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
  return surfaces;
}

void expectSumsOrMaximaNear(const hbPicture& found, const hbPicture& expected, const hbPlaneRays& rays,
                            const hbOglRoundingBounds& bounds) {
  EXPECT_EQ(channel(found, "A"), channel(expected, "A"));
  const std::vector<float> ys = channel(found, "Y"), exact = channel(expected, "Y");
  const double longest = glm::length(rays.field().geometry().extent()) + rays.step() * 16.0;
  const double tolerance = rays.scene().mode == hbMode::xray ? bounds.sums() * longest : bounds.values();
  for (std::size_t i = 0; i < ys.size(); ++i)
    EXPECT_NEAR(ys[i], exact[i], tolerance + 0x1p-22 * std::abs(exact[i])) << i;
}

hbScene planewise(hbMode mode, const hbCamera& camera) {
  hbScene scene = sceneOf(mode, camera, 19, 13);
  scene.sampling.kind = hbSampling::Kind::planewise;
  return scene;
}

const glm::dvec3 kLitSlopes(0.6, 1.0, 0.75);
double litLinear(const glm::dvec3& p) { return glm::dot(kLitSlopes, p); }
constexpr double kApart = 0.02; ///< What counts as another light.

/// Of a field of those slopes.
void expectLitNear(const hbPicture& found, const hbPicture& expected, const hbCombinationSparseGrid& grid,
                   const hbScene& scene) {
  const hbPlaneRays rays(grid, scene);
  const hbLitBounds bounds(rays, kLitSlopes);
  // Of either engine, values of one component grid, or of its nine lines, with 24 roundings at most and no partial sum
  // greater than a value; at points that are rounded 8 times (see hbOglRoundingBounds). Those of a difference are
  // rounded once more, but else the same.
  EXPECT_EQ(grid.grids().size(), 1U);
  const hbOglRoundingBounds values(grid, rays);
  const double rounded = 24.0 * 0x1p-24 * values.largest(), slopes = kLitSlopes.x + kLitSlopes.y + kLitSlopes.z;
  const double perValue = 2.0 * (rounded + 8.0 * 0x1p-24 * values.reach() * slopes) + ofLookUp(rays, values.largest());
  const double perDifference = 2.0 * 2.0 * (rounded + 0x1p-24 * slopes);
  // Roundings by 2^-24: of the ray some 40 (see hbDvrBounds) and of a place 12, up to 4 units from the cube's corner
  // and 3 and more from the light; of the gradient's way to the world, of lengths and products 20, of the gloss 16.
  constexpr double kPerDirection = 128.0 * 0x1p-24;
  const std::vector<float> opacities = channel(expected, "A"), ours = channel(found, "A");
  for (std::size_t i = 0; i < opacities.size(); ++i) {
    const double moved = bounds.channel(i, perValue, perDifference, kPerDirection, true) + 0x1p-22;
    EXPECT_LT(moved, kApart);
    for (const char* name : {"R", "G", "B", "A", "Y"})
      EXPECT_NEAR(channel(found, name)[i], channel(expected, name)[i], moved) << name << i;
  }
}

int countApart(const hbPicture& a, const hbPicture& b) {
  int count = 0;
  for (std::size_t i = 0; i < channel(a, "R").size(); ++i)
    count += std::abs(double(channel(a, "R")[i]) - double(channel(b, "R")[i])) > kApart;
  return count;
}

} // namespace

TEST_P(hbOglRaycasterTest, XrayAndMipAreThePlanewisePicturesOfTheCombination) {
  for (const hbGeometry& g : {box({9, 9, 9}, {1.0, 1.0, 1.0}), awkward(), box({9, 1, 5}, {1.0, 0.3, 2.0})}) {
    const hbSparseGrid grid = gridOf(g, 3, {waves});
    const hbCombinationSparseGrid combination(grid);
    for (const hbCamera& camera : cameras(g))
      for (const hbMode mode : {hbMode::xray, hbMode::mip}) {
        const hbScene scene = planewise(mode, camera);
        const hbPlaneRays rays(combination, scene);
        hbOglRoundingBounds bounds(combination, rays);
        expectSumsOrMaximaNear(drawn(grid, scene), hbRaycaster(combination, scene).render(), rays,
                               bounds.withTexels(GetParam().texels));
      }
  }
}

TEST_P(hbOglRaycasterTest, IsoSurfacesAreThePlanewiseOnes) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {linear});
  const hbCombinationSparseGrid combination(grid);
  int surfaces = 0;
  for (const hbCamera& camera : cameras(g)) {
    const hbScene scene = planewise(hbMode::iso, camera);
    const hbPlaneRays rays(combination, scene);
    surfaces += expectSurfacesNear(drawn(grid, scene), hbRaycaster(combination, scene).render(), rays,
                                   hbOglRoundingBounds(combination, rays).withTexels(GetParam().texels).values());
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

// Of what is in the box alone, that between two planes included. Box and volume share no face.
TEST_P(hbOglSceneTest, ClippedIsThePlanewisePicture) {
  const hbGeometry g = awkward();
  const hbSparseGrid waving = gridOf(g, 2, {waves}), rising = gridOf(g, 2, {linear});
  const hbScene::ClipBox box{{0.2, 0.1, 0.3}, {0.9, 0.7, 0.8}};
  int surfaces = 0, between = 0;
  const hbCamera camera = cameras(g)[18]; // oblique, by perspective
  for (const hbMode mode : {hbMode::xray, hbMode::mip, hbMode::iso, hbMode::dvr}) {
    const bool isIso = mode == hbMode::iso, isDvr = mode == hbMode::dvr;
    const hbSparseGrid& grid = isIso ? rising : waving;
    const hbCombinationSparseGrid combination(grid);
    hbScene scene = isDvr ? dvrScene(ramp(), camera, 5, hbSampling::Kind::planewise) : planewise(mode, camera);
    const hbPicture whole = drawn(grid, scene);
    scene.clip = box;
    const hbPlaneRays rays(combination, scene);
    const hbPicture expected = hbRaycaster(combination, scene).render(), found = drawn(grid, scene);
    EXPECT_NE(channel(found, "A"), channel(whole, "A"));
    hbOglRoundingBounds bounds(combination, rays);
    bounds.withTexels(GetParam().texels);
    if (isDvr) {
      expectNear(found, expected, rays, ofValues(combination, rays, GetParam().texels));
      for (const hbPlaneRays::Ray& ray : rays.rays()) between += ray.last < ray.first && ray.before > 0.0;
    } else if (isIso) {
      surfaces += expectSurfacesNear(found, expected, rays, bounds.values());
    } else {
      expectSumsOrMaximaNear(found, expected, rays, bounds);
    }
  }
  EXPECT_GT(surfaces, 10);
  EXPECT_GT(between, 3);
}

// From other places, pictures are those of a new renderer; what stands on the device belongs to no place.
TEST_P(hbOglSceneTest, LooksAreThoseOfANewOne) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  const std::vector<hbCamera> some{cameras(g)[0], cameras(g)[18]};
  const hbSampling sampling = planewise(hbMode::xray, some[0]).sampling;
  EXPECT_NE(sampling.stepLength(g, some[0]), sampling.stepLength(g, some[1]));
  const bool isLit = GetParam().options.form != hbOglRaycaster::Form::blend || GetParam().options.readBack;
  for (const hbMode mode : {hbMode::xray, hbMode::iso, hbMode::dvr}) {
    hbScene scene = mode == hbMode::dvr ? dvrScene(ramp(), some[0], 9) : planewise(mode, some[0]);
    if (mode == hbMode::dvr && isLit) scene.shading.emplace();
    std::vector<hbPicture> pictures;
    for (const hbCamera& camera : some) {
      scene.camera = camera;
      pictures.push_back(drawn(grid, scene));
    }
    EXPECT_NE(pictures[0].channels, pictures[1].channels);
    hbOglRaycaster caster(*context, grid, scene, GetParam().options);
    for (const std::size_t i : {0, 1}) { // it was made for the second
      caster.look(some[i]);
      const hbPicture picture = caster.render();
      EXPECT_EQ(picture.channels, pictures[i].channels);
      EXPECT_EQ(picture.metadata, pictures[i].metadata);
    }
  }
}

// Of a linear field, whose gradient is known. Some rays meet none of four planes.
TEST_P(hbOglLitTest, IsThePlanewisePicture) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 1, {litLinear});
  const hbCombinationSparseGrid combination(grid);
  const hbCamera oblique = cameras(g)[6], perspective = cameras(g)[18];
  int seen = 0;
  for (const auto& [camera, isPreintegrated, isPlaced] :
       {std::tuple(oblique, false, true), {perspective, false, false}, {perspective, true, true}}) {
    hbScene scene = dvrScene(ramp(4.0), camera, 4, hbSampling::Kind::planewise);
    const hbPicture unlit = hbRaycaster(combination, scene).render();
    scene.preintegrated = isPreintegrated;
    scene.shading = isPlaced ? placedLight(g, camera, kLitSlopes) : hbShading{};
    if (!isPlaced) scene.gradientOpacity = {0.1, 1.1};
    const hbPicture expected = hbRaycaster(combination, scene).render();
    expectLitNear(drawn(grid, scene), expected, combination, scene);
    seen += countApart(unlit, expected);
  }
  EXPECT_GT(seen, 100);
}

// By gradients alone; where there are none, lights shine from everywhere.
TEST_P(hbOglLitTest, GradientOpacityAndNoGradient) {
  const hbGeometry g = awkward();
  const hbSparseGrid rising = gridOf(g, 1, {litLinear}), flat = gridOf(g, 2, {[](const glm::dvec3&) { return 0.5; }});
  hbScene scene = dvrScene(ramp(4.0), cameras(g)[6], 9, hbSampling::Kind::planewise);
  const std::vector<float> whole = channel(drawn(rising, scene), "A");
  scene.gradientOpacity = {0.1, 1.1};
  const hbCombinationSparseGrid combination(rising);
  const hbPicture found = drawn(rising, scene);
  expectLitNear(found, hbRaycaster(combination, scene).render(), combination, scene);
  for (std::size_t i = 0; i < whole.size(); ++i)
    EXPECT_TRUE(whole[i] <= 0.01F || channel(found, "A")[i] < 0.95F * whole[i]) << i;
  const std::vector<float> nothing = channel(drawn(flat, scene), "A");
  EXPECT_EQ(nothing, std::vector<float>(nothing.size(), 0.0F));

  scene.gradientOpacity.reset();
  const hbPicture unlit = drawn(flat, scene);
  scene.shading.emplace();
  scene.shading->lights = {{{0.0, 0.0, 0.0}, {1.0, 0.5, 2.0}}, {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}};
  const hbPicture lit = drawn(flat, scene);
  EXPECT_EQ(channel(lit, "A"), channel(unlit, "A"));
  const glm::dvec3 matter = 0.3 + 0.8 * (glm::dvec3(1.0, 0.5, 2.0) + glm::dvec3(0.0, 1.0, 0.0));
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    // Products and sums of light in 32 bits, 8 roundings each of ten pieces' and of their sum.
    for (std::size_t i = 0; i < whole.size(); ++i)
      EXPECT_NEAR(channel(lit, name)[i], matter[c] * double(channel(unlit, name)[i]), 10.0 * 8.0 * 0x1p-24 * matter[c])
          << name << i;
  }
}

// Pictures in turn, of renderers that live at the same time, are those of a context that has seen nothing else.
TEST_P(hbOglLitTest, EverySceneShowsItself) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  hbScene scene = dvrScene(ramp(), hbCamera::framing(g), 9);
  std::vector<hbScene> scenes(3, scene);
  scenes[1].shading = placedLight(g, *scene.camera, kLitSlopes);
  scenes[2].shading.emplace();
  scenes[2].gradientOpacity = {0.0, 2.0};
  std::vector<hbPicture> pictures;
  std::vector<std::unique_ptr<hbOglRaycaster>> casters;
  context->release();
  for (const hbScene& one : scenes) {
    const auto fresh = hbGlContext::create(GetParam().kind);
    const hbGlCurrent thereCurrent(*fresh);
    pictures.push_back(hbOglRaycaster(*fresh, grid, one, GetParam().options).render());
  }
  context->makeCurrent();
  for (const hbScene& one : scenes)
    casters.push_back(std::make_unique<hbOglRaycaster>(*context, grid, one, GetParam().options));
  for (const std::size_t i : {1, 2, 0, 2, 1, 0}) {
    EXPECT_EQ(casters[i]->render().channels, pictures[i].channels) << i;
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(pictures[k].channels, pictures[i].channels);
  }
}

// Of more turns of loops than Mesa's software renderer takes in a draw (hbGlProgram::kMostTurns): 4300 planes of 31
// component grids or 26 lines, through matter of which all is seen, and through denser one, in which rays end at two
// thirds. There is no slope by which values could move anything.
TEST_P(hbOglLongTest, DvrIsThePlanewisePicture) {
  const hbGeometry g = box({33, 33, 33}, {1.0, 1.0, 1.0});
  const hbSparseGrid grid = gridOf(g, 5, {[](const glm::dvec3&) { return 0.5; }});
  for (const double opacity : {0.3, 1.0 - 0x1p-15})
    for (const bool isPreintegrated : {false, true}) {
      hbScene scene = dvrScene(constant(opacity), cameras(g)[0], 4300, hbSampling::Kind::planewise);
      scene.width = 4;
      scene.height = 3;
      scene.preintegrated = isPreintegrated;
      const hbPicture expected = hbRaycaster(grid, scene).render();
      expectNear(drawn(grid, scene), expected, hbPlaneRays(grid, scene), 0.0);
      EXPECT_GT(std::ranges::count_if(channel(expected, "A"), [&](float a) { return a > 0.99 * opacity; }), 1);
    }
}

// Seven values a sample.
TEST_P(hbOglLongTest, LitIsThePlanewisePicture) {
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 1, {litLinear});
  const hbCombinationSparseGrid combination(grid);
  const hbCamera perspective = cameras(g)[18];
  for (const bool isPreintegrated : {false, true}) {
    hbScene scene = dvrScene(ramp(4.0), perspective, 4300, hbSampling::Kind::planewise);
    scene.width = 4;
    scene.height = 3;
    scene.preintegrated = isPreintegrated;
    scene.shading = placedLight(g, perspective, kLitSlopes);
    expectLitNear(drawn(grid, scene), hbRaycaster(combination, scene).render(), combination, scene);
  }
}

TEST(hbOglRaycaster, BlendedPlanesHaveNoGradients) {
  const auto context = hbGlContext::create();
  const hbGlCurrent current(*context);
  const hbGeometry g = awkward();
  const hbSparseGrid grid = gridOf(g, 2, {waves});
  hbScene scene = dvrScene(ramp(), hbCamera::framing(g), 9);
  scene.gradientOpacity = {0.0, 1.0};
  for (int round = 0; round < 2; ++round) {
    try {
      hbOglRaycaster(*context, grid, scene, {hbOglRaycaster::Form::blend});
      ADD_FAILURE();
    } catch (const hbError& error) {
      EXPECT_EQ(std::string(error.what()),
                "shading: expected planes that are read back or another form, found the form blend");
    }
    scene.gradientOpacity.reset();
    scene.shading.emplace();
  }
  scene.mode = hbMode::mip; // which nothing lights
  EXPECT_NO_THROW(hbOglRaycaster(*context, grid, scene, {hbOglRaycaster::Form::blend}));
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
    positive += std::max(one.coefficient, 0.0);
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

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglRaycasterTest, testing::ValuesIn(testedWays()),
                         [](const auto& way) { return way.param.name; });
INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglDvrTest, testing::ValuesIn(someWays()),
                         [](const auto& way) { return way.param.name; });
INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglSceneTest,
                         testing::ValuesIn(waysNamed({"OsmesaBlend", "OsmesaBlendReadBack", "OsmesaFused",
                                                      "EglSeminodal"})),
                         [](const auto& way) { return way.param.name; });
INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglLongTest, testing::ValuesIn(waysNamed({"OsmesaFused", "EglSeminodal"})),
                         [](const auto& way) { return way.param.name; });
INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglLitTest,
                         testing::ValuesIn(waysNamed({"OsmesaBlendReadBack", "OsmesaFused", "EglSeminodal"})),
                         [](const auto& way) { return way.param.name; });
