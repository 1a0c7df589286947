#include "glcombine/hbOglPlaneCompositor.h"

#include <string>

namespace {

constexpr const char* kDeclarations = R"(
uniform sampler2D values, before;
uniform int first, count; // planes
uniform vec3 tiles; // columns, width, height
uniform int lastTile; // of `before`
uniform float iso, kLeast;
out vec4 result;
float numberIn(sampler2D target, int tile) {
  int columns = int(tiles.x);
  ivec2 pixel = ivec2(tile % columns, tile / columns) * ivec2(tiles.yz) + ivec2(gl_FragCoord.xy);
  return texelFetch(target, pixel, 0).r;
}
ivec2 tilesOfRay() { return clamp(planesOfRay() - first, ivec2(0, -1), ivec2(count, count - 1)); }
)";

// Each pixel writes what its blending equation leaves alone where the planes are none of its.
constexpr const char* kXray = R"(
void main() {
  ivec2 range = tilesOfRay();
  float sum = 0.0;
  for (int i = range.x; i <= range.y; ++i) sum += numberIn(values, i);
  result = vec4(sum);
})";
constexpr const char* kMip = R"(
void main() {
  ivec2 range = tilesOfRay();
  float greatest = kLeast;
  for (int i = range.x; i <= range.y; ++i) greatest = max(greatest, numberIn(values, i));
  result = vec4(greatest);
})";
constexpr const char* kIso = R"(
void main() {
  ivec2 range = tilesOfRay();
  bool isBegun = planesOfRay().x < first;
  float a = numberIn(before, lastTile), b = a;
  int i = range.x;
  for (; i <= range.y; ++i) {
    b = numberIn(values, i);
    if (isBegun && (a >= iso) != (b >= iso)) break;
    isBegun = true;
    a = b;
  }
  result = vec4(i <= range.y ? float(first + i - 1) + clamp((iso - a) / (b - a), 0.0, 1.0) : kNowhere);
})";

std::string fragments(hbMode mode) {
  return std::string("#version 330 core\n") + hbOglRays::glsl() + kDeclarations +
         (mode == hbMode::xray  ? kXray
          : mode == hbMode::mip ? kMip
                                : kIso);
}

} // namespace

hbOglPlaneCompositor::hbOglPlaneCompositor(const hbGlFunctions& gl, const hbScene& scene)
    : gl_(gl), mode_(scene.mode), quad_(gl), program_(gl, hbGlQuad::kVertexShader, fragments(scene.mode)),
      found_(gl, scene.width, scene.height, hbGlFormat::r32f) {}

void hbOglPlaneCompositor::begin(float iso) {
  iso_ = iso;
  found_.clear(mode_ == hbMode::xray ? 0.0F : mode_ == hbMode::mip ? kLeast : hbOglRays::kNowhere);
}

void hbOglPlaneCompositor::add(const hbOglRays& rays, int first, int count, const hbOglTiles& tiles,
                               const hbGlTarget& before, const hbGlTarget& values) {
  found_.bind();
  quad_.bind();
  program_.use();
  rays.set(program_, 2);
  values.texture().bind(0);
  before.texture().bind(1);
  program_.set("values", 0);
  program_.set("before", 1);
  program_.set("first", first);
  program_.set("count", count);
  program_.set("tiles", glm::vec3(tiles.columns(), tiles.width(), tiles.height()));
  program_.set("lastTile", tiles.count() - 1);
  program_.set("iso", iso_);
  program_.set("kLeast", kLeast);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE);
  gl_.BlendEquation(mode_ == hbMode::xray ? GL_FUNC_ADD : mode_ == hbMode::mip ? GL_MAX : GL_MIN);
  quad_.draw();
  gl_.Disable(GL_BLEND);
}
