#include "glcombine/hbOglPoints.h"

#include <algorithm>
#include <vector>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlTarget.h"

namespace {

constexpr const char* kFragments = R"(
uniform sampler2D points;
out float value;
void main() { value = valueAt(texelFetch(points, ivec2(gl_FragCoord.xy), 0).rgb); })";

constexpr std::size_t kRow = 1024; // points a draw: any device's textures are as wide

} // namespace

hbOglPoints::hbOglPoints(const hbGlContext& context, const hbOglValues& values)
    : gl_(context.gl()), values_(values),
      program_(gl_, hbGlQuad::kVertexShader, "#version 330 core\n" + values.glsl() + kFragments), quad_(gl_) {}

void hbOglPoints::values(const hbPoints& points, std::span<float> out) const {
  for (std::size_t first = 0; first < points.size(); first += kRow) {
    const hbPoints row = points.subspan(first, std::min(kRow, points.size() - first));
    std::vector<glm::vec3> texels;
    for (std::size_t i = 0; i < row.size(); ++i) texels.emplace_back(row.x[i], row.y[i], row.z[i]);
    const hbGlTexture texture(gl_, GL_TEXTURE_2D);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, GLsizei(row.size()), 1, 0, GL_RGB, GL_FLOAT, texels.data());
    texture.setFilter(GL_NEAREST);
    const hbGlTarget target(gl_, int(row.size()), 1, hbGlFormat::r32f);
    program_.use();
    values_.set(program_, 3);
    texture.bind(0);
    program_.set("points", 0);
    quad_.bind();
    quad_.draw();
    std::vector<float> read;
    target.read(read);
    std::copy(read.begin(), read.end(), out.begin() + std::ptrdiff_t(first));
  }
}
