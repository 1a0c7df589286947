#include "glcombine/hbOglFused.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include <fmt/format.h>

#include "glcombine/hbGlContext.h"

namespace {

// A pass shows the planes from firstPlane to lastPlane, and goes on from what those before have found.
constexpr const char* kPass = R"(
uniform sampler2D foundBefore;
uniform int firstPlane, lastPlane;
ivec2 planesOfPass() {
  ivec2 planes = planesOfRay();
  return ivec2(max(planes.x, firstPlane), min(planes.y, lastPlane));
}
vec4 found(float atFirst) {
  return firstPlane > 0 ? texelFetch(foundBefore, ivec2(gl_FragCoord.xy), 0) : vec4(atFirst);
}
)";

// Passes are whole blocks.
constexpr const char* kXray = R"(
out float result;
void main() {
  ivec2 planes = planesOfPass();
  float sum = found(0.0).r, block = 0.0;
  for (int i = planes.x; i <= planes.y; ++i) {
    block += valueAt(pointOfRay(float(i)));
    if ((i + 1 & kBlock - 1) == 0) {
      sum += block;
      block = 0.0;
    }
  }
  result = sum + block;
})";

constexpr const char* kMip = R"(
out float result;
void main() {
  ivec2 planes = planesOfPass();
  result = found(kLeast).r;
  for (int i = planes.x; i <= planes.y; ++i) result = max(result, valueAt(pointOfRay(float(i))));
})";

// Processors that run fragments side by side go through whatever is in the loop at every plane, so nothing is that a
// plane does not need. A pass begins on the last plane of the one before.
constexpr const char* kIso = R"(
uniform float iso;
out float result;
void main() {
  result = found(kNowhere).r;
  int first = max(planesOfRay().x, firstPlane - 1), last = result == kNowhere ? planesOfPass().y : -1;
  float before = 0.0, value = 0.0;
  int i = first;
  for (; i <= last; ++i) {
    value = valueAt(pointOfRay(float(i)));
    if (i > first && (before >= iso) != (value >= iso)) break;
    before = value;
  }
  if (i <= last) result = float(i - 1) + clamp((iso - before) / (value - before), 0.0, 1.0);
})";

// Here, too, slabs need the last plane of the pass before.
constexpr const char* kDvr = R"(
out vec4 result;
void main() {
  ivec2 planes = planesOfRay();
  vec3 lengths = lengthsOfRay();
  vec4 seen = found(0.0);
  float before = 0.0;
  int last = planesOfPass().y;
  for (int i = max(planes.x, firstPlane - 1); i <= last && !isOpaque(seen); ++i) {
    float value = valueAt(pointOfRay(float(i)));
    if (i >= firstPlane) addSample(seen, i, planes, lengths, before, value);
    before = value;
  }
  result = seen;
})";

// Of step 0 the value itself, of 1 to 6 that below and that above along each axis.
constexpr const char* kDifferences = R"(
uniform sampler2D places;
uniform vec3 spacing;
out vec4 result;
void main() {
  float place = texelFetch(places, ivec2(gl_FragCoord.xy), 0).r;
  vec3 point = pointOfRay(place);
  vec3 below = max(point - spacing, 0.0), above = min(point + spacing, 1.0);
  vec4 lower = vec4(0.0), upper = vec4(0.0);
  int steps = place == kNowhere ? 0 : 7;
  for (int i = 0; i < steps; ++i) {
    bvec4 isAxis = equal(ivec4(0, 1, 2, 3), ivec4((i + 1) / 2));
    bool isAbove = (i & 1) == 0;
    float value = valueAt(mix(point, isAbove ? above : below, isAxis.yzw));
    if (isAbove)
      upper = mix(upper, vec4(value), isAxis);
    else
      lower = mix(lower, vec4(value), isAxis);
  }
  result = vec4(upper.x, (upper.yzw - lower.yzw) / (above - below));
})";

} // namespace

hbOglFused::hbOglFused(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component)
    : gl_(context.gl()), values_(context, grid, component), quad_(gl_) {}
hbOglFused::hbOglFused(const hbGlContext& context, const hbSemiNodalGrid& grid, int component)
    : gl_(context.gl()), values_(context, grid, component), quad_(gl_) {}

const hbGlProgram& hbOglFused::prepared(std::unique_ptr<hbGlProgram>& program, const std::string& shader,
                                        const hbOglRays& rays, const hbGlTarget& out) const {
  assert(out.width() == rays.planes().scene().width && out.height() == rays.planes().scene().height);
  if (!program)
    program = std::make_unique<hbGlProgram>(
        gl_, hbGlQuad::kVertexShader,
        fmt::format("#version 330 core\nconst int kBlock = {};\nconst float kLeast = {};\n", kBlock, kLeast) +
            hbOglRays::glsl() + values_.glsl() + kPass + shader);
  program->use();
  rays.set(*program, 0);
  values_.set(*program, 1);
  quad_.bind();
  gl_.Disable(GL_BLEND);
  out.bind();
  return *program;
}

// One less, as there is the plane before. With the turn that ends the march, each loop in it counts once: two of
// valueAt(), and for each of two pieces of matter four of shine().
int hbOglFused::planesAPass(int turnsAPlane) const {
  constexpr int kEnd = 1 + 2 + 2 * 4;
  return std::max(1, (hbGlProgram::kMostTurns - kEnd) / turnsAPlane - 1);
}

void hbOglFused::draw(const hbGlProgram& program, int planes, int aPass, const hbGlTarget& out) const {
  constexpr int kRaysUnit = 0, kUnit = 3;
  const int passes = (planes + aPass - 1) / aPass;
  std::optional<hbGlTarget> other;
  if (passes > 1) {
    gl_.ActiveTexture(GL_TEXTURE0 + kUnit); // where a target's texture is bound as it is made
    other.emplace(gl_, out.width(), out.height(), hbGlFormat::r32f, out.channels());
  }
  program.set("foundBefore", other ? kUnit : kRaysUnit); // the first pass reads nothing there
  for (int pass = 0; pass < passes; ++pass) {
    const bool intoOut = (passes - pass) % 2 == 1; // so that the last one is
    if (other) (intoOut ? *other : out).texture().bind(kUnit);
    (intoOut ? out : *other).bind();
    program.set("firstPlane", pass * aPass);
    program.set("lastPlane", (pass + 1) * aPass - 1);
    quad_.draw();
  }
}

void hbOglFused::march(const hbOglRays& rays, const hbGlTarget& out) const {
  const hbMode mode = rays.planes().scene().mode;
  const char* shader = mode == hbMode::xray ? kXray : mode == hbMode::mip ? kMip : kIso;
  assert(std::size_t(mode) < march_.size());
  const hbGlProgram& program = prepared(march_[std::size_t(mode)], shader, rays, out);
  program.set("iso", rays.planes().iso());
  const int blocks = std::max(1, planesAPass(1 + values_.turns()) / kBlock);
  draw(program, rays.planes().planes(), blocks * kBlock, out);
}

void hbOglFused::composite(const hbOglRays& rays, const hbOglMatter& matter, const hbOglLight& light,
                           const hbGlTarget& out) const {
  const std::string shader = matter.glsl() + (matter.isLit() ? hbOglLight::glsl() : "") + kDvr;
  const std::size_t kind = (matter.isPreintegrated() ? 1 : 0) + (matter.isLit() ? 2 : 0);
  const hbGlProgram& program = prepared(composite_[kind], shader, rays, out);
  matter.set(program, 2);
  if (matter.isLit()) light.set(program);
  // Pieces of matter a plane: behind the last there may be another slab.
  const int pieces = matter.isPreintegrated() ? 2 : 1;
  const int lit = matter.isLit() ? pieces * hbOglLight::turns(values_.turns()) : 0;
  draw(program, rays.planes().planes(), planesAPass(1 + values_.turns() + lit), out);
}

void hbOglFused::differences(const hbOglRays& rays, const hbGlTarget& places, const hbGlTarget& out) const {
  const hbGlProgram& program = prepared(differences_, kDifferences, rays, out);
  places.texture().bind(2);
  program.set("places", 2);
  program.set("spacing", glm::vec3(rays.planes().field().geometry().cubeSpacing()));
  quad_.draw();
}
