#include "glcombine/hbOglFused.h"

#include <cassert>

#include <fmt/format.h>

#include "glcombine/hbGlContext.h"

namespace {

constexpr const char* kXray = R"(
out float result;
void main() {
  ivec2 planes = planesOfRay();
  float sum = 0.0, block = 0.0;
  for (int i = planes.x; i <= planes.y; ++i) {
    block += valueAt(pointOfRay(float(i)));
    if ((i & kBlock - 1) == 0) {
      sum += block;
      block = 0.0;
    }
  }
  result = sum + block;
})";

constexpr const char* kMip = R"(
out float result;
void main() {
  ivec2 planes = planesOfRay();
  result = kLeast;
  for (int i = planes.x; i <= planes.y; ++i) result = max(result, valueAt(pointOfRay(float(i))));
})";

// Processors that run fragments side by side go through whatever is in the loop at every plane, so nothing is that a
// plane does not need.
constexpr const char* kIso = R"(
uniform float iso;
out float result;
void main() {
  ivec2 planes = planesOfRay();
  float before = 0.0, value = 0.0;
  int i = planes.x;
  for (; i <= planes.y; ++i) {
    value = valueAt(pointOfRay(float(i)));
    if (i > planes.x && (before >= iso) != (value >= iso)) break;
    before = value;
  }
  result = i > planes.y ? kNowhere : float(i - 1) + clamp((iso - before) / (value - before), 0.0, 1.0);
})";

constexpr const char* kDvr = R"(
out vec4 result;
void main() {
  ivec2 planes = planesOfRay();
  vec3 lengths = lengthsOfRay();
  vec4 seen = vec4(0.0);
  float before = 0.0;
  for (int i = planes.x; i <= planes.y && !isOpaque(seen); ++i) {
    float value = valueAt(pointOfRay(float(i)));
    addSample(seen, i, planes, lengths, before, value);
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
            hbOglRays::glsl() + values_.glsl() + shader);
  program->use();
  rays.set(*program, 0);
  values_.set(*program, 1);
  quad_.bind();
  gl_.Disable(GL_BLEND);
  out.bind();
  return *program;
}

void hbOglFused::march(const hbOglRays& rays, const hbGlTarget& out) const {
  const hbMode mode = rays.planes().scene().mode;
  const char* shader = mode == hbMode::xray ? kXray : mode == hbMode::mip ? kMip : kIso;
  assert(std::size_t(mode) < march_.size());
  const hbGlProgram& program = prepared(march_[std::size_t(mode)], shader, rays, out);
  program.set("iso", rays.planes().iso());
  quad_.draw();
}

void hbOglFused::composite(const hbOglRays& rays, const hbOglMatter& matter, const hbOglLight& light,
                           const hbGlTarget& out) const {
  const std::string shader = matter.glsl() + (matter.isLit() ? hbOglLight::glsl() : "") + kDvr;
  const std::size_t kind = (matter.isPreintegrated() ? 1 : 0) + (matter.isLit() ? 2 : 0);
  const hbGlProgram& program = prepared(composite_[kind], shader, rays, out);
  matter.set(program, 2);
  if (matter.isLit()) light.set(program);
  quad_.draw();
}

void hbOglFused::differences(const hbOglRays& rays, const hbGlTarget& places, const hbGlTarget& out) const {
  const hbGlProgram& program = prepared(differences_, kDifferences, rays, out);
  places.texture().bind(2);
  program.set("places", 2);
  program.set("spacing", glm::vec3(rays.planes().field().geometry().cubeSpacing()));
  quad_.draw();
}
