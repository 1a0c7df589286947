#include "glcombine/hbOglSurfaceShader.h"

#include <string>

#include <glm/matrix.hpp>

namespace {

constexpr const char* kFragments = R"(
uniform sampler2D differences;
uniform mat3 gradientToWorld; // the inverse transpose of cube to world
out vec4 result;
void main() {
  vec3 gradient = gradientToWorld * texelFetch(differences, ivec2(gl_FragCoord.xy), 0).gba;
  float greatest = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
  vec3 ray = directionOfRay();
  vec3 normal = greatest > 0.0 ? normalize(gradient / greatest) : -ray; // squares would not go under or over
  if (dot(normal, ray) > 0.0) normal = -normal;
  result = vec4(normal, -dot(normal, ray));
})";

} // namespace

hbOglSurfaceShader::hbOglSurfaceShader(const hbGlFunctions& gl)
    : gl_(gl), quad_(gl),
      program_(gl, hbGlQuad::kVertexShader, std::string("#version 330 core\n") + hbOglRays::glsl() + kFragments) {}

void hbOglSurfaceShader::shade(const hbOglRays& rays, const hbGlTarget& differences, const hbGlTarget& out) const {
  gl_.Disable(GL_BLEND);
  out.clear(0.0F);
  quad_.bind();
  program_.use();
  rays.set(program_, 0);
  differences.texture().bind(1);
  program_.set("differences", 1);
  program_.set("gradientToWorld", glm::mat3(glm::transpose(glm::dmat3(rays.planes().worldToCube()))));
  quad_.draw();
}
