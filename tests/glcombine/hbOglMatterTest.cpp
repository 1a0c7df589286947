#include "glcombine/hbOglMatter.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlQuad.h"
#include "glcombine/hbGlTarget.h"

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

/// Of slabs or samples a quarter apart, with steps at either end, and a colour and an opacity of its own for what is no
/// number.
hbMatter matterOf(bool isPreintegrated) {
  hbTransferFunction::Definition d;
  d.colors = {{-0.25, {0.9, 0.4, 0.1}}, {0.1, {0.1, 0.8, 0.3}}, {1.75, {0.2, 0.3, 1.0}}};
  d.opacities = {{-0.25, 0.3}, {0.4, 0.9}, {1.75, 0.5}};
  d.belowColor = glm::dvec3(1.0, 0.0, 0.0);
  d.aboveColor = glm::dvec3(0.0, 0.0, 1.0);
  d.nanColor = {0.2, 0.4, 0.6};
  d.nanOpacity = 0.6;
  d.outside = hbTransferFunction::Outside::zero;
  d.unitLength = 0.5;
  hbScene scene;
  scene.mode = hbMode::dvr;
  scene.transfer = hbTransferFunction(std::move(d));
  scene.preintegrated = isPreintegrated;
  return {scene, hbValueMap{}, 0.25};
}

class hbOglMatterTest : public testing::TestWithParam<hbGlContext::Kind> {
protected:
  hbOglMatterTest() : context_(hbGlContext::create(GetParam())), current_(*context_) {}

  /// What a GLSL expression of `a` and `b` gives for such pairs.
  std::vector<glm::vec4> evaluated(const hbOglMatter& matter, const std::string& expression,
                                   const std::vector<glm::vec2>& pairs) const {
    const hbGlFunctions& gl = context_->gl();
    const hbGlProgram program(gl, hbGlQuad::kVertexShader, "#version 330 core\n" + matter.glsl() + R"(
uniform sampler2D pairs;
out vec4 result;
void main() {
  vec2 pair = texelFetch(pairs, ivec2(gl_FragCoord.xy), 0).rg;
  float a = pair.x, b = pair.y;
  result = )" + expression + ";\n}");
    const hbGlTexture texture(gl, GL_TEXTURE_2D);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, GLsizei(pairs.size()), 1, 0, GL_RG, GL_FLOAT, pairs.data());
    texture.setFilter(GL_NEAREST);
    const hbGlTarget target(gl, int(pairs.size()), 1, hbGlFormat::r32f, 4);
    const hbGlQuad quad(gl);
    program.use();
    matter.set(program, 3);
    texture.bind(0);
    program.set("pairs", 0);
    quad.bind();
    quad.draw();
    std::vector<float> read;
    target.read(read);
    std::vector<glm::vec4> out(pairs.size());
    for (std::size_t i = 0; i < read.size(); ++i) out[i / 4][int(i % 4)] = read[i];
    return out;
  }

  std::unique_ptr<hbGlContext> context_;
  hbGlCurrent current_;
};

/// First those for which no interpolation is needed, then others in between.
constexpr std::size_t kExact = 9;
std::vector<glm::vec2> numbersAround(float lo, float hi) {
  std::vector<glm::vec2> list;
  for (const float number : {kNan, -kInfinity, kInfinity, std::nextafter(lo, -kInfinity), std::nextafter(hi, kInfinity),
                             2.0F * lo - hi, 2.0F * hi - lo, lo, hi})
    list.emplace_back(number, 0.0F);
  std::mt19937 random(7);
  for (int i = 0; i < 400; ++i) list.emplace_back(std::uniform_real_distribution<float>(lo, hi)(random), 0.0F);
  return list;
}

} // namespace

TEST_P(hbOglMatterTest, SamplesAreTheTables) {
  const hbMatter matter = matterOf(false);
  const std::vector<glm::vec4>& entries = matter.table().entries();
  for (const hbValueMap& map : {hbValueMap{}, hbValueMap{-40.0, 0.125}}) {
    const std::vector<glm::vec2> numbers = numbersAround(float(map.fromTrue(matter.table().range().first)),
                                                         float(map.fromTrue(matter.table().range().second)));
    const std::vector<glm::vec4> found = evaluated(hbOglMatter(context_->gl(), matter, map), "matterAt(a)", numbers);
    // The number less the first one is rounded by 2^-24 of either, three times in all with the first one itself and the
    // product; and by that in cells.
    const double perNumber = double(entries.size() - 1) * map.scale / 2.0;
    const double inCells = 3.0 * 0x1p-24 * 2.0 * std::abs(map.fromTrue(1.75)) * perNumber + 4.0 * 0x1p-24 * 4096.0;
    EXPECT_LT(inCells, 1.0);
    double steepest[4] = {};
    for (std::size_t i = 0; i + 1 < entries.size(); ++i)
      for (int c = 0; c < 4; ++c)
        steepest[c] = std::max(steepest[c], std::abs(double(entries[i + 1][c]) - double(entries[i][c])));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      glm::dvec4 expected(matter.table().at(float(map.toTrue(numbers[i].x))));
      const double step = matter.step();
      for (int c = 0; c < 4; ++c) {
        const double scale = c == 3 ? step : 1.0;
        // At the range's ends and beyond there is nothing but the entry's product with the step.
        const double tolerance = (i < kExact ? 0.0 : steepest[c] * inCells) + 4.0 * 0x1p-24 * expected[c];
        EXPECT_NEAR(found[i][c], scale * expected[c], scale * tolerance) << numbers[i].x << " " << c;
      }
    }
  }
}

TEST_P(hbOglMatterTest, SlabsAreThePreintegrated) {
  const hbMatter matter = matterOf(true);
  const std::size_t n = matter.slabs().size();
  const std::vector<glm::vec4>& entries = matter.slabs().entries();
  const auto [lo, hi] = matter.slabs().range();
  std::vector<glm::vec2> pairs = numbersAround(float(lo), float(hi));
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].y = pairs[(i * 37 + 5) % pairs.size()].x;
  const std::vector<glm::vec4> found = evaluated(hbOglMatter(context_->gl(), matter, {}), "slabAt(a, b)", pairs);
  double steepest = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j + 1 < n; ++j)
      for (int c = 0; c < 4; ++c)
        steepest = std::max({steepest, std::abs(double(entries[i * n + j + 1][c]) - double(entries[i * n + j][c])),
                             std::abs(double(entries[(j + 1) * n + i][c]) - double(entries[j * n + i][c]))});
  // Places as above, of either value; interpolated three times, each with 3 roundings.
  const double inCells = 3.0 * 0x1p-24 * 2.0 * std::abs(hi) * double(n - 1) / (hi - lo) + 4.0 * 0x1p-24 * double(n);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (int c = 0; c < 4; ++c)
      EXPECT_NEAR(found[i][c], matter.slabs().at(pairs[i].x, pairs[i].y)[c],
                  2.0 * inCells * steepest + 9.0 * 0x1p-24 * 2.0)
          << pairs[i].x << " " << pairs[i].y << " " << c;
}

TEST_P(hbOglMatterTest, ExponentialAndLogarithmAreWithinEightUnits) {
  const hbMatter matter = matterOf(false);
  std::vector<glm::vec2> pairs{{0.0F, 0.0F}, {kInfinity, 1.0F}, {200.0F, 1.0F - 0x1p-24F}, {0x1p-60F, 0x1p-60F}};
  std::mt19937 random(11);
  for (int i = 0; i < 1000; ++i)
    pairs.emplace_back(std::exp2(std::uniform_real_distribution<float>(-30.0F, 6.0F)(random)),
                       i % 2 ? std::uniform_real_distribution<float>(0.0F, 1.0F)(random)
                             : std::exp2(std::uniform_real_distribution<float>(-30.0F, 0.0F)(random)));
  const std::vector<glm::vec4> found =
      evaluated(hbOglMatter(context_->gl(), matter, {}), "vec4(absorbed(a), depthOf(b), 0.0, 0.0)", pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double absorbed = -std::expm1(-double(pairs[i].x)), depth = -std::log1p(-double(pairs[i].y));
    EXPECT_NEAR(found[i].x, absorbed, 8.0 * 0x1p-24 * absorbed) << pairs[i].x;
    if (pairs[i].y < 1.0F)
      EXPECT_NEAR(found[i].y, depth, 8.0 * 0x1p-24 * depth) << pairs[i].y;
    else
      EXPECT_GT(found[i].y, 1e20F);
  }
}

INSTANTIATE_TEST_SUITE_P(OffScreen, hbOglMatterTest, testing::Values(hbGlContext::Kind::osmesa, hbGlContext::Kind::egl),
                         [](const auto& kind) { return kind.param == hbGlContext::Kind::egl ? "egl" : "osmesa"; });
