#include "glcombine/hbOglRaycaster.h"

#include <cmath>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "raycast/hbRaycaster.h"
#include "sparsegrid/hbCombinationSparseGrid.h"
#include "tests/glcombine/hbGlBounds.h"
#include "tests/raycast/hbTestScenes.h"

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

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglRaycasterTest, testing::ValuesIn(ways()),
                         [](const auto& way) { return way.param.name; });
