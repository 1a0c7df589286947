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

constexpr const char* kDvr = R"(
uniform sampler2D seenBefore;
void main() {
  ivec2 range = tilesOfRay(), planes = planesOfRay();
  vec3 lengths = lengthsOfRay();
  vec4 seen = texelFetch(seenBefore, ivec2(gl_FragCoord.xy), 0);
  float a = numberIn(before, lastTile);
  for (int i = range.x; i <= range.y && !isOpaque(seen); ++i) {
    float b = numberIn(values, i);
    addSample(seen, first + i, planes, lengths, a, b);
    a = b;
  }
  result = seen;
})";

std::string fragments(hbMode mode, const hbOglMatter* matter) {
  const std::string common = std::string("#version 330 core\n") + hbOglRays::glsl() + kDeclarations;
  switch (mode) {
  case hbMode::xray:
    return common + kXray;
  case hbMode::mip:
    return common + kMip;
  case hbMode::iso:
    return common + kIso;
  case hbMode::dvr:
  case hbMode::slice:
    break;
  }
  return common + matter->glsl() + kDvr;
}

} // namespace

hbOglPlaneCompositor::hbOglPlaneCompositor(const hbGlFunctions& gl, const hbScene& scene, const hbOglMatter* matter)
    : gl_(gl), mode_(scene.mode), matter_(matter), quad_(gl),
      program_(gl, hbGlQuad::kVertexShader, fragments(scene.mode, matter)) {
  const auto target = [&](int channels) {
    return std::make_unique<hbGlTarget>(gl, scene.width, scene.height, hbGlFormat::r32f, channels);
  };
  found_ = target(matter ? 4 : 1);
  if (matter) before_ = target(4);
}

void hbOglPlaneCompositor::begin(float iso) {
  iso_ = iso;
  found_->clear(mode_ == hbMode::mip ? kLeast : mode_ == hbMode::iso ? hbOglRays::kNowhere : 0.0F);
}

void hbOglPlaneCompositor::add(const hbOglRays& rays, int first, int count, const hbOglTiles& tiles,
                               const hbGlTarget& before, const hbGlTarget& values) {
  if (matter_) found_.swap(before_);
  found_->bind();
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
  if (matter_) {
    matter_->set(program_, 3);
    before_->texture().bind(4);
    program_.set("seenBefore", 4);
    gl_.Disable(GL_BLEND);
  } else {
    gl_.Enable(GL_BLEND);
    gl_.BlendFunc(GL_ONE, GL_ONE);
    gl_.BlendEquation(mode_ == hbMode::xray ? GL_FUNC_ADD : mode_ == hbMode::mip ? GL_MAX : GL_MIN);
  }
  quad_.draw();
  gl_.Disable(GL_BLEND);
}
