#include "glcombine/hbOglSparseGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "glcombine/hbGlContext.h"
#include "glcombine/hbGlPixels.h"
#include "glcombine/hbGlProgram.h"
#include "glcombine/hbGlTarget.h"

namespace {

constexpr const char* kVertexShader = R"(#version 330 core
uniform vec3 corner, right, down; // of the whole rectangle
out vec3 place;
void main() {
  vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  place = corner + at.x * right + at.y * down;
  gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
})";

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler3D nodes;
uniform vec3 scale, offset, from, beyond;
uniform float weight;
in vec3 place;
out vec4 value;
void main() {
  if (any(lessThan(place, from)) || any(greaterThanEqual(place, beyond))) discard;
  value = vec4(weight * texture(nodes, offset + scale * place).r);
})";

/// One texture and what its samples are multiplied with.
struct Term {
  hbGlTexture texture;
  glm::vec3 scale, offset, from, beyond;
  float weight; ///< Of the coefficient, without its sign.
};

} // namespace

struct hbOglSparseGrid::Parts {
  const hbGlFunctions& gl;
  Options options;
  hbGlProgram program;
  GLuint vertices = 0;
  std::vector<Term> positive, negative;
  std::int64_t bytes = 0;
  double low = 0.0, size = 1.0; ///< value = low + size * what is in the target
  mutable std::optional<hbGlTarget> target;

  Parts(const hbGlFunctions& functions, const Options& choice)
      : gl(functions), options(choice), program(gl, kVertexShader, kFragmentShader) {
    gl.GenVertexArrays(1, &vertices);
  }
  ~Parts() { gl.DeleteVertexArrays(1, &vertices); }

  void upload(const hbTextureLayout& layout, const hbSize3& nodes, const std::vector<float>& values, double coefficient,
              double divisor);
  void draw(const std::vector<Term>& terms) const;
};

void hbOglSparseGrid::Parts::upload(const hbTextureLayout& layout, const hbSize3& nodes,
                                    const std::vector<float>& values, double coefficient, double divisor) {
  for (const auto& z : layout.pieces(2))
    for (const auto& y : layout.pieces(1))
      for (const auto& x : layout.pieces(0)) {
        // Texels without a node are 0: the filter multiplies them with 0, which must not meet what is no number.
        std::vector<float> texels(std::size_t(x.texels * y.texels * z.texels), 0.0F);
        for (std::int64_t k = 0; k < z.nodes; ++k)
          for (std::int64_t j = 0; j < y.nodes; ++j)
            std::copy_n(values.begin() + x.firstNode + nodes.x * (y.firstNode + j + nodes.y * (z.firstNode + k)),
                        x.nodes, texels.begin() + x.texels * (j + y.texels * k));
        Term term{hbGlTexture(gl, GL_TEXTURE_3D),
                  {float(x.scale), float(y.scale), float(z.scale)},
                  {float(x.offset), float(y.offset), float(z.offset)},
                  {float(x.from), float(y.from), float(z.from)},
                  {},
                  float(std::abs(coefficient) / divisor)};
        // A plane that two pieces share belongs to the second; the cube's faces may be passed by what coordinates
        // round.
        constexpr float kRounding = 0x1p-21F;
        const std::array<double, 3> to{x.to, y.to, z.to};
        for (int d = 0; d < 3; ++d) {
          if (term.from[d] == 0.0F) term.from[d] = -kRounding;
          term.beyond[d] = to[std::size_t(d)] == 1.0 ? 1.0F + kRounding : float(to[std::size_t(d)]);
        }
        gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
        gl.TexImage3D(GL_TEXTURE_3D, 0, hb::internalFormat(options.textures), GLsizei(x.texels), GLsizei(y.texels),
                      GLsizei(z.texels), 0, GL_RED, GL_FLOAT, texels.data());
        for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
          gl.TexParameteri(GL_TEXTURE_3D, filter, GL_LINEAR);
        for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
          gl.TexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
        (coefficient > 0.0 ? positive : negative).push_back(std::move(term));
        bytes += x.texels * y.texels * z.texels * hb::glFormatBytes(options.textures);
      }
}

void hbOglSparseGrid::Parts::draw(const std::vector<Term>& terms) const {
  for (const Term& term : terms) {
    gl.BindTexture(GL_TEXTURE_3D, term.texture.name());
    program.set("scale", term.scale);
    program.set("offset", term.offset);
    program.set("from", term.from);
    program.set("beyond", term.beyond);
    program.set("weight", term.weight);
    gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

hbOglSparseGrid::hbOglSparseGrid(const hbGlContext& context, const hbCombinationSparseGrid& grid, int component,
                                 const Options& options)
    : parts_(std::make_unique<Parts>(context.gl(), options)) {
  double low = 0.0, size = 1.0, divisor = 1.0;
  if (hb::isFixedPoint(options.textures) || hb::isFixedPoint(options.target)) {
    float least = std::numeric_limits<float>::infinity(), greatest = -least;
    divisor = 0.0;
    for (const hbCombinationSparseGrid::Grid& one : grid.grids()) {
      const auto values = grid.values(one, component);
      const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
      least = std::min(least, *lo);
      greatest = std::max(greatest, *hi);
      divisor += std::max(one.coefficient, 0);
    }
    low = least;
    size = greatest > least ? double(greatest) - double(least) : 1.0;
    if (!hb::isFixedPoint(options.target)) divisor = 1.0;
  }
  parts_->low = low;
  parts_->size = size * divisor;
  glm::bvec3 flat;
  for (int d = 0; d < 3; ++d) flat[d] = grid.geometry().isFlat(d);
  for (const hbCombinationSparseGrid::Grid& one : grid.grids()) {
    const auto stored = grid.values(one, component);
    std::vector<float> values(stored.size());
    std::transform(stored.begin(), stored.end(), values.begin(),
                   [&](float value) { return float((double(value) - low) / size); });
    parts_->upload(hbTextureLayout(one.levels, flat, options.form, context.maxTextureSize3d()), one.nodes, values,
                   one.coefficient, divisor);
  }
}

hbOglSparseGrid::~hbOglSparseGrid() = default;

std::int64_t hbOglSparseGrid::textureBytes() const { return parts_->bytes; }
std::int64_t hbOglSparseGrid::textures() const {
  return std::int64_t(parts_->positive.size() + parts_->negative.size());
}

void hbOglSparseGrid::values(const Plane& plane, std::vector<float>& out) const {
  const hbGlFunctions& gl = parts_->gl;
  auto& target = parts_->target;
  if (!target || target->width() != plane.width || target->height() != plane.height)
    target.emplace(gl, plane.width, plane.height, parts_->options.target);
  target->clear(0.0F);
  gl.BindVertexArray(parts_->vertices);
  gl.ActiveTexture(GL_TEXTURE0);
  const hbGlProgram& program = parts_->program;
  program.use();
  program.set("nodes", 0);
  program.set("corner", glm::vec3(plane.corner));
  program.set("right", glm::vec3(double(plane.width) * plane.right));
  program.set("down", glm::vec3(double(plane.height) * plane.down));
  gl.Enable(GL_BLEND);
  gl.BlendFunc(GL_ONE, GL_ONE);
  gl.BlendEquation(GL_FUNC_ADD);
  parts_->draw(parts_->positive);
  gl.BlendEquation(GL_FUNC_REVERSE_SUBTRACT);
  parts_->draw(parts_->negative);
  target->read(out);
  for (float& value : out) value = float(parts_->low + parts_->size * double(value));
}
