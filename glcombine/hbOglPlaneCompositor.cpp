#include "glcombine/hbOglPlaneCompositor.h"

#include <string>

namespace {

constexpr const char* kDeclarations = R"(
uniform sampler2D values, before;
uniform int plane;
uniform float iso, kLeast;
out vec4 result;
)";

// Each pixel writes what its blending equation leaves alone where the plane is none of its.
constexpr const char* kXray = R"(
void main() {
  ivec2 range = planesOfRay();
  result = vec4(range.x <= plane && plane <= range.y ? texelFetch(values, ivec2(gl_FragCoord.xy), 0).r : 0.0);
})";
constexpr const char* kMip = R"(
void main() {
  ivec2 range = planesOfRay();
  result = vec4(range.x <= plane && plane <= range.y ? texelFetch(values, ivec2(gl_FragCoord.xy), 0).r : kLeast);
})";
constexpr const char* kIso = R"(
void main() {
  ivec2 range = planesOfRay(), pixel = ivec2(gl_FragCoord.xy);
  float a = texelFetch(before, pixel, 0).r, b = texelFetch(values, pixel, 0).r;
  bool isCrossing = range.x < plane && plane <= range.y && (a >= iso) != (b >= iso);
  result = vec4(isCrossing ? float(plane - 1) + clamp((iso - a) / (b - a), 0.0, 1.0) : kNowhere);
})";

std::string fragments(hbMode mode) {
  return std::string("#version 330 core\n") + hbOglRays::glsl() + kDeclarations +
         (mode == hbMode::xray  ? kXray
          : mode == hbMode::mip ? kMip
                                : kIso);
}

} // namespace

hbOglPlaneCompositor::hbOglPlaneCompositor(const hbGlFunctions& gl, const hbOglRays& rays, float iso)
    : gl_(gl), rays_(rays), iso_(iso), quad_(gl),
      program_(gl, hbGlQuad::kVertexShader, fragments(rays.planes().scene().mode)),
      found_(gl, rays.planes().scene().width, rays.planes().scene().height, hbGlFormat::r32f) {
  const hbMode mode = rays.planes().scene().mode;
  found_.clear(mode == hbMode::xray ? 0.0F : mode == hbMode::mip ? kLeast : hbOglRays::kNowhere);
}

void hbOglPlaneCompositor::add(int index, const hbGlTarget& before, const hbGlTarget& values) {
  const hbMode mode = rays_.planes().scene().mode;
  found_.bind();
  quad_.bind();
  program_.use();
  rays_.set(program_, 2);
  values.texture().bind(0);
  before.texture().bind(1);
  program_.set("values", 0);
  program_.set("before", 1);
  program_.set("plane", index);
  program_.set("iso", iso_);
  program_.set("kLeast", kLeast);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE);
  gl_.BlendEquation(mode == hbMode::xray ? GL_FUNC_ADD : mode == hbMode::mip ? GL_MAX : GL_MIN);
  quad_.draw();
  gl_.Disable(GL_BLEND);
}
